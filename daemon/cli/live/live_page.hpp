// The page of `odomcalibctl view`: one HTML document, style and script inline (live_page.html).
#pragma once

#include <string>

namespace odomcalib::cli {

std::string live_page();

}  // namespace odomcalib::cli
