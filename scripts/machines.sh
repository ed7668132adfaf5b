# shellcheck shell=bash
# Other machines: cross-compiled, and run under qemu. After packages.sh and build.sh.

# Those whose answers test_machine compares. Each has a toolchain of its name.
# shellcheck disable=SC2034  # for those who source this
machines=(armel armhf i386 ppc64el riscv64 s390x)

# test_machine MACHINE [CTEST ARGUMENT...]: the hashes of answers. The library has 3 dimensions
# and little optimisation.
test_machine() {
  local machine=$1 toolchain triple
  shift
  # shellcheck disable=SC2154  # root is the caller's
  toolchain=$root/toolchains/$machine.cmake
  triple=$(sed -n 's/^set(triple \(.*\))$/\1/p' "$toolchain")
  install_packages "g++-$triple" googletest qemu-user
  build_preset machine -B "$machine" "-DCMAKE_TOOLCHAIN_FILE=$toolchain" hash_test
  test_preset machine -B "$machine" --tests-regex '^hash_test[.]' "$@"
}

arm_packages=(
  g++-aarch64-linux-gnu qemu-user
  libbenchmark-dev:arm64 libgmp-dev:arm64 libgtest-dev:arm64 libhwy-dev:arm64)

# prepare_arm: what the presets aarch64 and aarch64-clang need besides what every
# build does.
prepare_arm() {
  if ! command -v dpkg >/dev/null; then
    say "Cross-compiling needs Debian's packages for arm64, and there is no dpkg" \
      "here. On an arm64 machine ./test.sh tests it as it is."
    exit 1
  fi
  if [ "$(dpkg --print-architecture)" != arm64 ] &&
    ! dpkg --print-foreign-architectures | grep -qx arm64; then
    become_root "dpkg --add-architecture arm64"
    # shellcheck disable=SC2154  # become_root has set as_root
    step "add Debian's arm64" "${as_root[@]}" dpkg --add-architecture arm64
  fi
  install_packages "${arm_packages[@]}"
}
