# shellcheck shell=bash
# Sourced by engine: how this machine reaches package archives, as secrets and arguments of a build.

# In each secret, so that tests can tell where one has gone: a comment, and a certificate of nobody, which was valid for
# a day and is no authority.
SECRET_MARK='# of a secret that no layer may hold: 71c0d6f29ab5'
CERTIFICATE_MARK='-----BEGIN CERTIFICATE-----
MIIBrzCCAVagAwIBAgIUZJMRzSY2XKgPkPoA+JUO8TDfCBUwCgYIKoZIzj0EAwIw
LzEtMCsGA1UEAwwkS2V5bHVtZSB0ZXN0cywgbm9ib2R5IHRvIGJlIGJlbGlldmVk
MB4XDTI2MTEyMjIyMzY0N1oXDTI2MTEyMzIyMzY0N1owLzEtMCsGA1UEAwwkS2V5
bHVtZSB0ZXN0cywgbm9ib2R5IHRvIGJlIGJlbGlldmVkMFkwEwYHKoZIzj0CAQYI
KoZIzj0DAQcDQgAEDo4pqXmk+ER0o2GoYi5tH4onUfBwDlwusoZTyhApY6G/AlK0
KL3kv2I3kxq4WvvTM+kXhGXRGg3P2+BEEv7hxKNQME4wHQYDVR0OBBYEFPSqMoWO
bSk3KV2rRdjpph+rrz4JMB8GA1UdIwQYMBaAFPSqMoWObSk3KV2rRdjpph+rrz4J
MAwGA1UdEwEB/wQCMAAwCgYIKoZIzj0EAwIDRwAwRAIgWaEmm3HUiB6/t42w6oXf
jO0bxA0iWm3FU4CMsywzJaECID6v6sXbBDIgvmCG1O+2gYLD94JQo8/d/dMRbL5f
88Y4
-----END CERTIFICATE-----'

# Every npmrc that npm here reads, but for paths on this machine.
npm_secret() {
  local file
  { command -v npm >/dev/null && npm config get globalconfig userconfig 2>/dev/null | sed 's/^[a-z]*=//'; echo /etc/npmrc; } |
    sort -u | while read -r file; do
      [ ! -r "$file" ] || { grep -vE '^[[:space:]]*(cafile|cache|prefix|nodedir|tmp|script-shell)[[:space:]]*=' "$file" || true; echo; }
    done
}

# Where apt is told of a proxy and nobody else is.
apt_proxy() {
  local P=""
  eval "$(apt-config shell P Acquire::http::Proxy)"
  [ "$P" = DIRECT ] || echo "$P"
}

build_secrets() {
  local certificates=/etc/ssl/certs/ca-certificates.crt name proxy
  mkdir -p "$folder/secrets"
  chmod 700 "$folder/secrets"
  { echo "$SECRET_MARK"; npm_secret; } >"$folder/secrets/npmrc"
  # Where this machine has none, nothing is to be believed instead of what the image knows.
  : >"$folder/secrets/certificates"
  [ ! -r "$certificates" ] || { cat "$certificates"; echo "$CERTIFICATE_MARK"; } >"$folder/secrets/certificates"
  for name in npmrc certificates; do echo "--secret=id=$name,src=$folder/secrets/$name"; done
  # Docker knows these arguments, and keeps them out of the image's history.
  for name in http_proxy https_proxy no_proxy HTTP_PROXY HTTPS_PROXY NO_PROXY; do
    [ -z "${!name:-}" ] || echo "--build-arg=$name"
  done
  proxy=$(apt_proxy)
  [ -z "$proxy" ] || [ -n "${http_proxy:-}${HTTP_PROXY:-}" ] || echo "--build-arg=http_proxy=$proxy"
}
