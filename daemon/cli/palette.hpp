// Colours of everything that a browser shows.
#pragma once

#include <string_view>

namespace odomcalib::cli {

/// One palette a scheme; orange and blue stay apart for colour-blind readers. On paper it is the light one.
inline constexpr std::string_view kPalette = R"(
:root{color-scheme:light dark;--ink:#222;--paper:#fff;--rule:#d8d8d8;--before:#b84f14;--after:#1769aa;--reference:#6b6b6b;
--good:#1a7f37;--doubtful:#8a5a00;--bad:#b3261e}
@media screen and (prefers-color-scheme:dark){:root{--ink:#ddd;--paper:#16181b;--rule:#3a3d42;--before:#f0975a;
--after:#6cb6f5;--reference:#a8a8a8;--good:#5fce7e;--doubtful:#e5b34a;--bad:#ff8a80}}
)";

}  // namespace odomcalib::cli
