# The robot computer's CPU, with Debian's cross compiler; tests run under qemu-user.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)
set(CMAKE_CROSSCOMPILING_EMULATOR qemu-aarch64-static)
# Static, so that qemu needs no target root.
set(CMAKE_EXE_LINKER_FLAGS_INIT "-static")
# Eigen is headers only: the host's copy serves.
set(Eigen3_DIR /usr/share/eigen3/cmake)
