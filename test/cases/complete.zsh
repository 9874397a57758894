# zsh -f complete.zsh COMPLETION PROGRAM LINE WANTED: types a line and Tab into an interactive zsh, and waits for the words wanted.
zmodload zsh/zpty && zpty line 'TERM=dumb zsh -f -i' || exit
zpty -w line "gearsweep() { ${(q)2} \"\$@\" }; . ${(q)1}; bindkey '^I' complete-word; print be''gun"
zpty -r -m line shown '*begun*' && zpty -w -n line "$3"$'\t' && zpty -r -m line shown "*$4*" && exit
print -r -- "$shown"
exit 1
