# shellcheck shell=bash
# Sourced by scripts that fetch a package of another suite than the system's: apt with its signatures, under a
# configuration of its own in a temporary folder. Nothing on the system changes and root is not needed.

# Prints "ORIGIN URI" of the archive this machine already uses. The names come from the configured sources, whether their
# lists have been fetched or not.
configured_archive() {
  local id
  id=$(. /etc/os-release && echo "$ID")
  apt-get update --print-uris 2>/dev/null | sed -n "s|^'\(.*\)/dists/.*InRelease'.*|\1|p" |
    awk -v id="$id" '$1 !~ /security/ && $1 ~ ("/" id "/?$") { print id, $1; exit }'
}

# Everything apt reads or writes lies in FOLDER; proxies and the like are taken over from the system's configuration.
write_private_configuration() { # FOLDER deb|deb-src ORIGIN URI SUITE COMPONENT
  local folder=$1 keyring="/usr/share/keyrings/$3-archive-keyring.gpg" signed=""
  mkdir -p "$folder"/{parts,preferences.d,sources.list.d,state/lists/partial,cache/archives/partial,log}
  cp /etc/apt/apt.conf.d/* "$folder/parts/" 2>/dev/null || true
  cat >"$folder/parts/zz-private" <<CONF
#clear APT::Update::Post-Invoke;
#clear APT::Update::Post-Invoke-Success;
APT::Sandbox::User "$(id -un)";
CONF
  [ "$2" = deb ] || echo '#clear Acquire::IndexTargets::deb;' >>"$folder/parts/zz-private"
  cat >"$folder/apt.conf" <<CONF
Dir::Etc::Parts "$folder/parts";
Dir::Etc::SourceList "$folder/sources.list";
Dir::Etc::SourceParts "$folder/sources.list.d";
Dir::Etc::PreferencesParts "$folder/preferences.d";
Dir::Etc::Preferences "$folder/preferences";
Dir::State "$folder/state";
Dir::State::status "$folder/status";
Dir::Cache "$folder/cache";
Dir::Log "$folder/log";
CONF
  : >"$folder/status"
  [ -r "$keyring" ] && signed="[signed-by=$keyring] "
  echo "$2 $signed$4 $5 $6" >"$folder/sources.list"
}
