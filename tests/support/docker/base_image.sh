# shellcheck shell=bash
# Sourced by engine: the base image, from a registry or made here.

# What Debian's image of that name leaves out, left out here too, also of packages that are installed later.
slim_down() { # ROOT_FOLDER
  cat >"$1/etc/dpkg/dpkg.cfg.d/docker" <<'CONF'
path-exclude /usr/share/doc/*
path-include /usr/share/doc/*/copyright
path-exclude /usr/share/info/*
path-exclude /usr/share/locale/*
path-exclude /usr/share/man/*
CONF
  printf '%s\n' 'APT::Install-Recommends "true";' 'Acquire::Languages "none";' 'Acquire::GzipIndexes "true";' \
    'DPkg::Post-Invoke { "rm -f /var/cache/apt/archives/*.deb || true"; };' >"$1/etc/apt/apt.conf.d/docker"
  find "$1/usr/share/doc" -type f ! -name copyright -delete  # links to folders of others stay
  find "$1/usr/share/doc" -type d -empty -delete
  rm -rf "$1"/usr/share/{info,locale,man}/* "$1"/var/cache/apt/* "$1"/var/lib/apt/lists/* "$1"/var/log/*.log \
    "$1"/debootstrap "$1"/etc/machine-id
  rm -f "$1/etc/hostname" "$1/etc/resolv.conf"
}

# Prints the security archive that this machine uses, if any.
security_archive() {
  apt-get indextargets --format '$(REPO_URI)' 'Identifier: Packages' 2>/dev/null | grep -m 1 security || true
}

write_sources() { # ROOT_FOLDER URI
  local keyring=/usr/share/keyrings/debian-archive-keyring.gpg security
  security=$(security_archive)
  rm -f "$1/etc/apt/sources.list"
  printf 'Types: deb\nURIs: %s\nSuites: %s\nComponents: main\nSigned-By: %s\n' \
    "$2" "$BASE_SUITE $BASE_SUITE-updates" $keyring >"$1/etc/apt/sources.list.d/debian.sources"
  [ -z "$security" ] || printf '\nTypes: deb\nURIs: %s\nSuites: %s\nComponents: main\nSigned-By: %s\n' \
    "$security" "$BASE_SUITE-security" $keyring >>"$1/etc/apt/sources.list.d/debian.sources"
}

bootstrap_base_image() { # TAR
  local uri work proxy
  uri=$(. /etc/os-release; [ "$ID" = debian ] && configured_archive | cut -d ' ' -f 2)
  [ -n "$uri" ] || fail "no registry gives $BASE_IMAGE, and apt here knows no Debian archive to make it from"
  work=$(mktemp -d "$folder/bootstrap.XXXXXX")
  # debootstrap fetches with wget, which does not read what apt was told.
  proxy=$(apt-config shell P Acquire::http::Proxy) && eval "$proxy"
  [ -z "${P:-}" ] || [ "$P" = DIRECT ] || export http_proxy="$P"
  say "making $BASE_IMAGE with debootstrap, once (some 40 s)"
  debootstrap --variant=minbase "$BASE_SUITE" "$work/root" "$uri" >"$folder/debootstrap.log" 2>&1 ||
    { tail -n 20 "$folder/debootstrap.log" >&2; rm -rf "$work"; fail "debootstrap failed"; }
  slim_down "$work/root"
  write_sources "$work/root" "${uri%/}"
  tar -C "$work/root" --numeric-owner -cf "$1.part" .
  mv "$1.part" "$1"
  rm -rf "$work"
}

have_base_image() {
  local tar
  ! docker image inspect "$BASE_IMAGE" >/dev/null 2>&1 || return 0
  tar="$(dirname "$folder")/${BASE_IMAGE/:/-}.tar"
  if [ ! -f "$tar" ]; then
    ! timeout 60 docker pull -q "$BASE_IMAGE" >/dev/null 2>&1 || return 0
    bootstrap_base_image "$tar"
  fi
  docker import --change 'CMD ["bash"]' "$tar" "$BASE_IMAGE" >/dev/null || fail "docker import failed"
}
