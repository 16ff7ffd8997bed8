# shellcheck shell=bash
# Sourced by engine: how this machine reaches package archives, as secrets and arguments of a build.

# apt's own words, without what concerns its folders, hooks and how packages are unpacked.
apt_secret() {
  apt-config dump | grep -E '^Acquire::' | grep -vE '^Acquire::(Languages|GzipIndexes|IndexTargets|CompressionTypes)' || true
}

# Every npmrc that npm here reads, but for paths on this machine.
npm_secret() {
  local file
  { command -v npm >/dev/null && npm config get globalconfig userconfig 2>/dev/null | sed 's/^[a-z]*=//'; echo /etc/npmrc; } |
    sort -u | while read -r file; do
      [ ! -r "$file" ] || { grep -vE '^[[:space:]]*(cafile|cache|prefix|nodedir|tmp|script-shell)[[:space:]]*=' "$file" || true; echo; }
    done
}

build_secrets() {
  local certificates=/etc/ssl/certs/ca-certificates.crt name
  mkdir -p "$folder/secrets"
  chmod 700 "$folder/secrets"
  apt_secret >"$folder/secrets/apt.conf"
  npm_secret >"$folder/secrets/npmrc"
  if [ -r "$certificates" ]; then cp "$certificates" "$folder/secrets/certificates"; else : >"$folder/secrets/certificates"; fi
  for name in apt.conf npmrc certificates; do echo "--secret=id=$name,src=$folder/secrets/$name"; done
  # Docker knows these arguments, and keeps them out of the image's history.
  for name in http_proxy https_proxy no_proxy HTTP_PROXY HTTPS_PROXY NO_PROXY; do
    [ -z "${!name:-}" ] || echo "--build-arg=$name"
  done
}
