#!/usr/bin/env bash
# A robot whose dimensions differ from the nominal values is calibrated through its wires. The robot is simulated (CANopen drive
# behind an slcan port, 2D lidar on a serial port); the daemon and the command line are the real ones. Needs no hardware.
# The robot also has a defect that the program does not know of, drawn from the simulator's own list, part of which is in
# no catalogue. At the end the truth is shown beside what was found, and the error before and after on a fresh drive.
#
# Works on a fresh Debian 12 as root, or as a user with sudo; installs and builds what is missing. Robot and service run on
# one clock, which is as fast as the processor while the robot moves. Four to seven minutes on two processors the first time, one after
# that.
#
# usage: ./demo.sh [--real-time] [--full] [--effect NAME] [SEED]
#     SEED           number that robot and defect are drawn from; default: another each time
#     --real-time    robot and service as programs of their own, in real time: five minutes
#     --full         the long pattern instead of the quick one
#     --effect NAME  this defect instead of one drawn (odomcalib-sim --help lists them); none: no defect
# Exit status 0: the calibration was accepted and more figures of odometry are better than worse; the last line says which. Results: build/demo.
set -euo pipefail
cd "$(dirname "$0")"

real_time=no plan=--quick effect=random seed=$((RANDOM % 9000 + 1000))
usage() { echo "usage: ./demo.sh [--real-time] [--full] [--effect NAME] [SEED]" >&2; exit 2; }
while [ $# -gt 0 ]; do
  case $1 in
    --real-time) real_time=yes ;;
    --full) plan= ;;
    --effect) [ $# -gt 1 ] || usage; effect=$2; shift ;;
    -h | --help) sed -n '2,/^set /{/^#/s/^# \{0,1\}//p}' "$0"; exit 0 ;;
    *[!0-9]* | '') usage ;;
    *) seed=$1 ;;
  esac
  shift
done

as_root() { if [ "$(id -u)" -eq 0 ]; then "$@"; else sudo "$@"; fi; }
steps=9 step_number=0
# Bold on a terminal: how far the demo is, what comes now, and how long it has taken.
step() {
  step_number=$((step_number + 1))
  local line="== $step_number of $steps, $SECONDS s: $*"
  if [ -t 1 ]; then printf '\n\033[1m%s\033[0m\n' "$line"; else printf '\n%s\n' "$line"; fi
}
fail() { printf '\ndemo failed: %s\n' "$*" >&2; exit 1; }
run() { printf '\n$ odomcalibctl %s\n' "$*"; "$bin/odomcalibctl" --socket "$dir/control" "$@"; }

install_packages() {
  local missing=()
  while read -r package; do
    case $package in '# checks'*) break ;; '' | \#*) continue ;; esac
    dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q 'ok installed' || missing+=("$package")
  done < tests/packages.txt
  [ ${#missing[@]} -eq 0 ] && return
  echo "installing ${#missing[@]} packages"
  export DEBIAN_FRONTEND=noninteractive
  { as_root apt-get update && as_root apt-get install -y --no-install-recommends "${missing[@]}"; } \
    > build/demo/install.log 2>&1 || { tail -n 20 build/demo/install.log; fail "apt-get, see build/demo/install.log"; }
}

build() {
  step "building (the first time takes some minutes; what was built stays in build/release)"
  local launcher=()
  if command -v ccache > /dev/null; then
    launcher=(-DCMAKE_C_COMPILER_LAUNCHER=ccache -DCMAKE_CXX_COMPILER_LAUNCHER=ccache)
  fi
  # The tests need more packages than this; test.sh adds them to what is built here.
  local tests=()
  [ -e build/release/CMakeCache.txt ] || tests=(-DODOMCALIB_TESTS=OFF)
  cmake --preset release "${tests[@]}" "${launcher[@]}" > build/demo/configure.log ||
    fail "cmake, see build/demo/configure.log"
  local programs=(odomcalibctl odomcalib-demo)
  [ $real_time = no ] || programs+=(odomcalibd odomcalib-sim)
  cmake --build build/release -j "$(nproc)" --target "${programs[@]}"
}

# Everything that runs in the background ends with this script, whatever ends it.
sim= daemon= dir=
end_process() { [ -z "$1" ] || { kill "$1" 2> /dev/null && wait "$1" 2> /dev/null; } || true; }
clean_up() {
  trap '' INT TERM HUP
  end_process "$daemon"
  end_process "$sim"
  [ -z "$dir" ] || { cp "$dir"/*.log build/demo/ 2> /dev/null || true; rm -rf "$dir"; }
}
trap clean_up EXIT
trap 'exit 130' INT
trap 'exit 143' TERM HUP

start_robot() {
  mkdir "$dir/ports"
  mkfifo "$dir/faults"
  exec 3<> "$dir/faults"
  [ $real_time = yes ] || return 0
  local defect=()
  [ "$effect" = none ] || defect=(--effect "$effect")
  "${hurry[@]}" "$bin/odomcalib-sim" --seed "$seed" "${defect[@]}" --link "$dir/ports" --truth "$dir/truth.json" --commands \
    < "$dir/faults" > "$dir/simulator.log" 2>&1 &
  sim=$!
  for _ in $(seq 100); do [ -e "$dir/ports/lidar" ] && break; sleep 0.1; done
  [ -e "$dir/ports/lidar" ] || fail "the simulator did not start: $(cat "$dir/simulator.log")"
  cat "$dir/simulator.log"
}

write_configuration() {
  # Both ends share this machine's processors, which may stand still for longer than three life signs of 30 ms.
  sed 's/^period_ms = 30$/period_ms = 100/' drivers/base/profiles/sim-dual.toml > "$dir/sim-dual.toml"
  cat > "$dir/odomcalib.toml" << TOML
[controller]
device = "slcan:$dir/ports/can?bitrate=500000"
profile = "$dir/sim-dual.toml"
[lidar]
device = "serial:$dir/ports/lidar?baud=230400"
pose = [0.10, 0.0, 0.0]
[robot]
id = "demo"
wheel_diameter = 0.150
track_width = 0.400
[limits]
countdown = 1.0
[lcm]
enabled = false
[daemon]
state_dir = "$dir/state"
socket = "$dir/control"
TOML
}

# The nominal values, for odometry as it was before.
write_papers() {
  cat > build/demo/nominal.toml << TOML
wheel_diameter = 0.150
track_width = 0.400
lidar_pose = [0.10, 0.0, 0.0]
TOML
}

# Everything is there, and the dimensions were read from the drive.
ready() {
  "$bin/odomcalibctl" --socket "$dir/control" --json=short check 2> /dev/null | python3 -c '
import json, sys
checks = json.load(sys.stdin)["checks"]
read = any(c["found"] == "from the controller" for c in checks)
sys.exit(not read or any(c["outcome"] != "ok" for c in checks))' 2> /dev/null
}

start_daemon() {
  if [ $real_time = yes ]; then
    "${hurry[@]}" "$bin/odomcalibd" --config "$dir/odomcalib.toml" >> "$dir/odomcalibd.log" 2>&1 &
    daemon=$!
  elif [ -z "$daemon" ]; then
    local defect=()
    [ "$effect" = none ] || defect=(--effect "$effect")
    "$bin/odomcalib-demo" --seed "$seed" "${defect[@]}" --folder "$dir" --config "$dir/odomcalib.toml" \
      < "$dir/faults" >> "$dir/odomcalibd.log" 2>&1 &
    daemon=$!
  fi
  for _ in $(seq 60); do ready && return; sleep 0.2; done
  run check || true
  fail "odomcalibd did not find the robot: $(cat "$dir/odomcalibd.log")"
}

# A protective stop is a result, not a failure of the program: the robot stood still. On a busy machine the simulated
# robot itself may be late; then the drive is repeated.
drive() { # FILE VERB...
  local file=$1 status=0
  shift
  printf '\n$ odomcalibctl %s\n' "$*"
  for _ in 1 2 3 4 5; do
    status=0
    "$bin/odomcalibctl" --socket "$dir/control" --json=short "$@" --yes > "$file" || status=$?
    case $status in 0) break ;; 4 | 5 | 6) echo "exit status $status; once more" ;; *) fail "exit status $status" ;; esac
    sleep 2
  done
  [ "$status" -eq 0 ] || fail "exit status $status"
  python3 - "$file" << 'PYTHON'
import json, math, sys
for move in json.load(open(sys.argv[1]))["moves"]:
    x, y, yaw = move["odometry"]
    if move["error"] is None:
        sys.exit("no lidar reference")
    print(f"{move['move']:<17} odometry {math.hypot(x, y):7.4f} m {math.degrees(yaw):8.3f} deg; error "
          f"{1000 * move['error']['distance']:+6.1f} mm {math.degrees(move['error']['yaw']):+7.3f} deg")
PYTHON
}

calibrate() {
  local status=0
  for _ in 1 2 3 4 5; do
    status=0
    run calibrate $plan --yes --out build/demo/calibration.json || status=$?
    case $status in 0) return ;; 3) fail "the calibration was refused" ;; 4 | 5 | 6) echo "exit status $status; once more" ;;
      *) fail "exit status $status" ;; esac
    sleep 2
  done
  fail "exit status $status"
}

# Where the simulated robot really is, at rest: the file is written again and again.
true_pose() { sleep $([ $real_time = yes ] && echo 1.5 || echo 0.3); python3 -c 'import json, sys; print(json.dumps(json.load(open(sys.argv[1]))["pose"]))' "$dir/truth.json"; }

# A drive that no value was fitted to, judged by where the simulated robot really went. Odometry from its ticks alone.
fresh_drive() { # NAME VERB...
  local name=$1 recording
  shift
  true_pose > "build/demo/fresh-$name.begin"
  drive "build/demo/fresh-$name.json" "$@"
  true_pose > "build/demo/fresh-$name.end"
  recording=$(ls -t "$dir"/state/recordings/*.lcmlog | head -n 1)
  cp "$recording" "build/demo/fresh-$name.lcmlog"
  python3 docs/scripts/demo_table.py --without-effects build/demo/calibration.json build/demo/geometry.json
  for kind in nominal geometry calibration; do
    local values=build/demo/$kind.json
    [ "$kind" = nominal ] && values=nominal
    "$bin/odomcalibctl" predict "build/demo/fresh-$name.lcmlog" --robot build/demo/nominal.toml --calibration "$values" \
      --trajectory "build/demo/fresh-$name.$kind.tum" > /dev/null || fail "predict"
  done
}

power_cycle() {
  if [ $real_time = yes ]; then
    echo "reset drive" >&3
    end_process "$daemon"
  else
    echo "power cycle" >&3
    sleep 0.5
  fi
  start_daemon
}

mkdir -p build/demo
rm -rf build/demo/*
install_packages
build
bin=$PWD/build/release/bin
# The simulated robot must keep its times: in memory, and before others if that is allowed.
dir=$(mktemp -d "$([ -w /dev/shm ] && echo /dev/shm || echo /tmp)/odomcalib-demo.XXXXXX")
hurry=()
if chrt -R --rr 10 true 2> /dev/null; then hurry=(chrt -R --rr 10); fi

step "a robot is drawn (seed $seed): its true dimensions differ from the nominal values by 1 to 3 %, and it has a defect"
start_robot
write_configuration
write_papers
start_daemon
run status
run check
run params get

step "before: a metre out and back, a turn each way; odometry compared with the lidar from rest to rest"
drive build/demo/straight-before.json straight
drive build/demo/spin-before.json spin

step "calibration: guided drive, recording, least squares, search for what the model lacks"
calibrate
cp "$dir"/state/recordings/*.lcmlog build/demo/

step "write-back: read, journal, write, read back, store"
run apply build/demo/calibration.json --yes

step "power cycle: the drive is reset, the daemon begins afresh and reads the values that the drive kept"
power_cycle
run params get | tee build/demo/params-after.txt
run --json=short params get | tail -n 1 > build/demo/params-after.json
run history

step "after: the same drives, fresh"
fresh_drive straight straight
fresh_drive spin spin
fresh_drive turns spin --turns 2 --direction ccw  # errors of turns both ways would cancel

step "the report, from the calibration file"
run report build/demo/calibration.json --html build/demo/report.html > build/demo/report.txt
echo "report: build/demo/report.html"

step "result"
cp "$dir/truth.json" build/demo/
status=0
python3 docs/scripts/demo_table.py build/demo || status=$?
cat << NEXT

next
  the report of this drive     build/demo/report.html
  a bag or another recording   build/release/bin/odomcalibctl solve drive.bag --robot robot.toml --report report.html
                               (docs/user/from-a-bag.md)
  a robot                      docs/user/tutorial.md, the same steps by hand; to install: README.md, "Install"
  every check and test         ./test.sh
NEXT
exit $status
