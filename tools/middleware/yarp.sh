# shellcheck shell=bash
# YARP from the source distribution on PyPI: its server, its tools, the devices that the
# lessons use, and bindings for Lua and python3. It is built once, some minutes on two cores.

yarp_version=3.5.0
yarp_sha256=7a8f78e1b6d3477fcd5e73fd5839ebf6971c3c0f5d3208d3ec0ee2b0c44507b9
ycm_version=0.15.3

# Carriers and devices; YARP's defaults take twice as long.
yarp_plugins=(
  yarpcar_portmonitor yarpmod_fakeMotionControl yarpmod_controlboardwrapper2
  yarpmod_controlBoard_nws_yarp yarpmod_remote_controlboard yarpmod_fakeFrameGrabber
  yarpmod_grabberDual
)

yarp_options=(
  -DCMAKE_BUILD_TYPE=Release
  # More optimization would cost more time than the tests would gain.
  "-DCMAKE_CXX_FLAGS_RELEASE=-O1 -DNDEBUG"
  -DCMAKE_INSTALL_LIBDIR=lib
  -DBUILD_SHARED_LIBS=ON
  # Without ACE, YARP resolves names with gethostbyname, which crashes when two threads connect at the
  # same time, for example when a port is opened while another program connects to it.
  -DSKIP_ACE=OFF
  -DYARP_COMPILE_GUIS=OFF
  -DYARP_COMPILE_TESTS=OFF
  -DYARP_COMPILE_EXAMPLES=OFF
  -DYARP_COMPILE_BINDINGS=ON
  -DCREATE_LUA=ON
  -DCREATE_PYTHON=ON
  -DCMAKE_INSTALL_PYTHON3DIR:STRING=lib/python3
  -DYARP_COMPILE_DEVICE_PLUGINS=ON
)

for plugin in "${yarp_plugins[@]}"; do
  yarp_options+=("-DENABLE_$plugin=ON")
done

# The sources are from 2021; current compilers require these headers.
yarp_headers=(algorithm array cstdint functional iterator limits memory mutex string utility)
yarp_flags=
for header in "${yarp_headers[@]}"; do
  yarp_flags+="-include $header "
done
yarp_options+=("-DCMAKE_CXX_FLAGS=$yarp_flags")

# The name server also joins the multicast group 224.2.1.1, on the interface of the default route: here
# it stays on the loopback interface. The simulated motors do not stop their thread, which crashes in one
# of ten stops.
yarp_patches=(
  src/libYARP_os/src/yarp/os/impl/DgramTwoWayStream.cpp
  's/dmcast->join(addr, 1)/dmcast->join(addr, 1, ACE_TEXT("lo"))/'
  src/devices/fakeMotionControl/fakeMotionControl.cpp
  's/yCTrace(FAKEMOTIONCONTROL) << " close()";/yarp::os::PeriodicThread::stop();/'
)

# Changes the sources.
yarp_patch() {
  local file script
  while [ $# -gt 0 ]; do
    file=$yarp_work/sources/$1 script=$2
    cp "$file" "$file.before"
    sed -i "$script" "$file"
    ! cmp -s "$file" "$file.before" || die "$1 is not as expected: there is nothing to change"
    shift 2
  done
}

yarp_download() {
  local tarball=$yarp_work/yarp_middleware-$yarp_version.tar.gz
  # pip also downloads the build tools, to read the name of the package.
  [ -e "$tarball" ] || quietly python3 -m pip download --disable-pip-version-check --no-deps \
    --no-binary yarp-middleware --dest "$yarp_work" "yarp-middleware==$yarp_version" ||
    die "pip could not download yarp-middleware $yarp_version"
  printf '%s  %s\n' "$yarp_sha256" "$tarball" | sha256sum --check --quiet - ||
    die "$tarball has a wrong checksum" "delete it and try again"
  if [ ! -e "$yarp_work/sources/complete" ]; then
    rm -rf "$yarp_work/sources"
    mkdir -p "$yarp_work/sources"
    tar -xf "$tarball" -C "$yarp_work/sources" --strip-components 1
    sed -i 's/DEFAULT ON/DEFAULT OFF/' "$yarp_work"/sources/src/{devices,carriers}/*/CMakeLists.txt
    yarp_patch "${yarp_patches[@]}"
    touch "$yarp_work/sources/complete"
  fi
  # YARP's CMake modules, which its users need, too.
  quietly python3 -m pip install --disable-pip-version-check --no-deps --upgrade \
    --target "$yarp_prefix/share/ycm" "ycm-cmake-modules==$ycm_version" ||
    die "pip could not install ycm-cmake-modules $ycm_version"
}

# Precompiles headers that most sources include, which halves the time for most of them.
# It must have the same options as YARP's build, including -Wvla, which defines a macro.
yarp_precompile() {
  local kind header=$yarp_work/headers.hpp
  mkdir -p "$header.gch"
  printf '#include <%s>\n' "${yarp_headers[@]}" atomic chrono cmath condition_variable cstdio \
    cstdlib cstring deque fstream iostream list map set sstream stdexcept thread tuple vector >"$header"
  for kind in PIC PIE; do
    quietly nice c++ -x c++-header -std=c++14 -O1 -DNDEBUG "-f$kind" -fvisibility=hidden \
      -fvisibility-inlines-hidden -Wvla -o "$header.gch/$kind" "$header" ||
      die "YARP's headers could not be precompiled"
  done
}

# An interrupted build is resumed.
yarp_build() {
  say "building YARP $yarp_version into $yarp_prefix, once: some minutes"
  mkdir -p "$yarp_work" "$yarp_prefix"
  yarp_download
  yarp_precompile
  quietly nice cmake -S "$yarp_work/sources" -B "$yarp_work/build" -G Ninja "${yarp_options[@]}" \
    -DYCM_DIR="$yarp_prefix/share/ycm/ycm_cmake_modules/share/cmake/YCM" \
    -DPython3_EXECUTABLE="$(python3 -c 'import sys; print(sys.executable)')" \
    -DCMAKE_CXX_FLAGS="-include $yarp_work/headers.hpp" -DCMAKE_INSTALL_PREFIX="$yarp_prefix" || die "YARP could not be configured"
  quietly nice ninja -C "$yarp_work/build" install || die "YARP could not be built"
  rm -rf "$yarp_work"
  touch "$yarp_prefix/complete"
}

need_packages libace-dev libeigen3-dev libtinyxml-dev libedit-dev libsqlite3-dev liblua5.4-dev swig g++ cmake ninja-build \
  iproute2
[ -e "$(python3 -c 'import sysconfig; print(sysconfig.get_path("include"))')/Python.h" ] ||
  need_packages python3-dev

yarp_key=$(
  {
    printf '%s\n' "$yarp_sha256" "$ycm_version" "${yarp_patches[@]}" "${yarp_options[@]}"
    c++ --version
    python3 -c 'import sys; print(sys.executable, sys.version)'
  } | sha256sum | cut -c1-12
)
yarp_prefix=$CACHE/yarp-$yarp_version-$yarp_key
yarp_work=$yarp_prefix.build
[ -e "$yarp_prefix/complete" ] || yarp_build

setting YARP_PREFIX "$yarp_prefix"
setting PATH "$yarp_prefix/bin:$PATH"
setting LD_LIBRARY_PATH "$yarp_prefix/lib${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}"
setting YARP_DATA_DIRS "$yarp_prefix/share/yarp"
setting PYTHONPATH "$yarp_prefix/lib/python3${PYTHONPATH:+:$PYTHONPATH}"
setting LUA_CPATH "$yarp_prefix/lib/lua/5.4/?.so;;"
setting CMAKE_PREFIX_PATH "$yarp_prefix"
