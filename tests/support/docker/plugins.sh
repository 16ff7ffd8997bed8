# shellcheck shell=bash
# Sourced by engine: compose v2 and buildx for this `docker`. Debian 12 has neither; Debian 13's packages hold programs
# that want nothing else, so they are taken out of the packages and not installed.

missing_plugins() {
  docker compose version >/dev/null 2>&1 || echo docker-compose
  docker buildx version >/dev/null 2>&1 || echo docker-buildx
}

# The configuration of who runs this stays where it has both: it says which Engine is asked, and by which name.
have_plugins() {
  local missing
  mapfile -t missing < <(missing_plugins)
  [ ${#missing[@]} != 0 ] || return 0
  # Of ours the context is the default one.
  export DOCKER_HOST="${DOCKER_HOST:-$(docker context inspect --format '{{.Endpoints.docker.Host}}')}"
  export DOCKER_CONFIG="$folder/config"
  mkdir -p "$DOCKER_CONFIG/cli-plugins"
  mapfile -t missing < <(missing_plugins)
  [ ${#missing[@]} = 0 ] || fetch_plugins "${missing[@]}"
  mapfile -t missing < <(missing_plugins)
  [ ${#missing[@]} = 0 ] || fail "these do not run here: ${missing[*]}"
}

fetch_plugins() { # PACKAGE...
  local origin uri work package
  read -r origin uri < <(configured_archive) || fail "no Debian archive among the configured apt sources"
  [ "$origin" = debian ] || fail "compose v2 and buildx are missing: install docker-compose-v2 and docker-buildx"
  work=$(mktemp -d "$folder/plugins.XXXXXX")
  say "fetching $* of $BASE_SUITE with apt, once; nothing is installed"
  write_private_configuration "$work" deb debian "$uri" "$BASE_SUITE" main
  (
    cd "$work"
    export APT_CONFIG="$work/apt.conf"
    apt-get -qq update || apt-get -qq -o Acquire::Check-Valid-Until=false update
    apt-get -qq download "$@"
    for package in *.deb; do dpkg-deb --extract "$package" unpacked; done
  ) >"$folder/plugins.log" 2>&1 || { tail -n 20 "$folder/plugins.log" >&2; rm -rf "$work"; fail "apt could not fetch $*"; }
  find "$work/unpacked" -path '*/cli-plugins/*' -type f -exec cp {} "$DOCKER_CONFIG/cli-plugins/" \;
  rm -rf "$work"
}
