#include "daemon/service/service.hpp"

#include "daemon/service/disk_worker.hpp"
#include "daemon/service/json_text.hpp"
#include "daemon/service/loop.hpp"
#include "daemon/service/status_report.hpp"

namespace odomcalib {

Service::Service(std::unique_ptr<Loop> loop) : loop_(std::move(loop)) {}
Service::~Service() { stop_all("the daemon ends"); }

Result<std::unique_ptr<Service>> Service::create(const Config& config, Clock& clock, Calibrator calibrator,
                                                 std::unique_ptr<Background> disk, EventLog log,
                                                 Urgency urgency) {
  auto base = BaseLink::create(config.controller_device, config.controller_profile);
  if (!base) return base.error();
  auto lidar = LidarLink::create(config.lidar_device, config.lidar_type);
  if (!lidar) return lidar.error();
  auto folder = StateFolder::open(config.state_dir);
  if (!folder) return folder.error();
  const auto open_journal = folder.value().read_only() ? Journal::open_read_only : Journal::open;
  auto journal = open_journal(config.state_dir / "journal");
  if (!journal) return journal.error();
  auto server = ControlServer::create(config.socket, config.group);
  if (!server) return server.error();
  if (!disk) disk = std::make_unique<DiskWorker>();
  Opened opened{std::move(base).value(),   std::move(lidar).value(),   std::move(server).value(),
                std::move(folder).value(), std::move(journal).value(), std::move(urgency)};
  auto loop = std::make_unique<Loop>(config, clock, std::move(calibrator), std::move(opened), std::move(disk),
                                     std::move(log));
  return std::unique_ptr<Service>(new Service(std::move(loop)));
}

void Service::poll_once(int timeout_ms) {
  loop_->wait(timeout_ms);
  loop_->turn();
}

void Service::stop_all(const std::string& why) { loop_->stop_all(why); }
bool Service::drive_off() const { return loop_->parts().drive.off(); }
bool Service::writing() const { return loop_->parts().write_back.busy(); }
std::string Service::status_line() const { return one_line(loop_->parts(), loop_->task()); }
std::string Service::status_json() const { return json_text(status_report(loop_->parts(), loop_->task())); }

}  // namespace odomcalib
