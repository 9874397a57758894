# Completion of gearsweep's command line, for bash and zsh: `. app/completion.sh`, or the copy that app/install.sh installs.
# Options, tasks, groups and keys are those that the command itself describes.

if [ -n "${ZSH_VERSION-}" ]; then
  autoload -U +X compinit && compinit -u
  autoload -U +X bashcompinit && bashcompinit
fi

# _gearsweep_names COMMAND WHAT: the names of its tasks, groups or keys.
_gearsweep_names() { "$1" --describe "$2" 2>/dev/null | sed -n 's/^.*{.*"name": "\([a-z_0-9]*\)".*/\1/p'; }

# _gearsweep_keys COMMAND GROUP: the names of the group's keys.
_gearsweep_keys() { "$1" --describe keys 2>/dev/null | sed -n "s/^.*{\"group\": \"$2\", \"name\": \"\([a-z_0-9]*\)\".*/\1/p"; }

_gearsweep_options() { "$1" --help 2>/dev/null | sed -n 's/^  \(--[a-z-]*\).*/\1/p' | sort -u; }

_gearsweep() {
  local command=$1 word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]} first=${COMP_WORDS[1]} words=
  case $first in
    --new) words="--short $(_gearsweep_names "$command" tasks)" ;;
    --describe) words='all tasks groups keys key' ;;
    --help)
      if [ "$COMP_CWORD" = 2 ]; then
        words=$(for what in tasks groups keys; do _gearsweep_names "$command" $what; done | sort -u)
      else
        words=$(_gearsweep_keys "$command" "${COMP_WORDS[2]#&}")
      fi ;;
    *)
      case $before in
        --out) COMPREPLY=($(compgen -d -- "$word")); return ;;
        --name | --threads) COMPREPLY=(); return ;;
      esac
      case $word in
        -*) words=$(_gearsweep_options "$command") ;;
        *) COMPREPLY=($(compgen -f -X '!*.nml' -- "$word") $(compgen -d -- "$word")); return ;;
      esac ;;
  esac
  COMPREPLY=($(compgen -W "$words" -- "$word"))
}

complete -o filenames -F _gearsweep gearsweep
