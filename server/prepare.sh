# shellcheck shell=bash
# Shared by server/run and tests/run, which source it: installs what is missing and builds.
# Expects $program (for messages), $root (the checkout) and $assume_yes (yes or no).

say() { printf '%s\n' "$*"; }
fail() {
  printf "%s: %s\n" "$program" "$*" >&2
  exit 1
}

packages_of() { # GROUP...
  local group package
  while read -r group package _; do
    [[ " $* " != *" $group "* ]] || echo "$package"
  done <"$root/server/packages.txt"
}

# What is installed, and what that stands in for: node's own packages hold npm, and Debian's cannot be beside them.
installed_packages() {
  dpkg-query -W -f '${db:Status-Status} ${Package}, ${Provides}\n' | sed -n 's/^installed //p' | tr ',' '\n' |
    sed 's/^ *//; s/ .*//'
}

missing_packages() { # GROUP...
  local package installed
  installed=$(installed_packages)
  for package in $(packages_of "$@"); do
    grep -qxF -- "$package" <<<"$installed" || echo "$package"
  done
}

# Says what will be installed and asks, unless we are root or were told --yes.
install_missing() { # GROUP...
  if ! command -v apt-get >/dev/null || ! command -v dpkg-query >/dev/null; then
    say "This is not Debian or Ubuntu. Install what these packages hold, then run again with --no-install:"
    grep -E "^($(echo "$@" | tr ' ' '|')) " "$root/server/packages.txt"
    exit 1
  fi
  local missing
  missing=$(missing_packages "$@" | tr '\n' ' ')
  [ -z "$missing" ] && return 0
  say "To be installed with apt: $missing"
  local as_root=()
  if [ "$(id -u)" != 0 ]; then
    command -v sudo >/dev/null || fail "not root, and no sudo here: install them and run again"
    as_root=(sudo)
    if [ "$assume_yes" != yes ]; then
      read -r -p "Install them with sudo? [y/N] " answer || answer=n
      case $answer in [yY]*) ;; *) fail "nothing installed" ;; esac
    fi
  fi
  say "Installing them (build/apt.log)"
  "${as_root[@]}" apt-get -qq update || fail "apt-get update failed"
  # shellcheck disable=SC2086  # a list of package names
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -qq -y --no-install-recommends install $missing \
    >"$root/build/apt.log" 2>&1 || { tail -n 20 "$root/build/apt.log" >&2; fail "apt-get install failed"; }
}

configure_release() { # CMAKE_OPTION...
  local launcher=()
  [ -f "$root/build/release/build.ninja" ] || say "Configuring the build (build/configure.log)"
  command -v ccache >/dev/null && launcher=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache)
  (cd "$root" && cmake --preset release "${launcher[@]}" "$@") >"$root/build/configure.log" 2>&1 ||
    { cat "$root/build/configure.log" >&2; fail "configuring failed"; }
}

build_release() { # TARGET...
  local targets=()
  [ $# -gt 0 ] && targets=(--target "$@")
  cmake --build "$root/build/release" "${targets[@]}" || fail "building failed"
}
