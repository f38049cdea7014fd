# Completion of odomcalibctl in fish. Verbs and options are asked of the program itself: its help is the one list of them.

function __odomcalibctl_words
    set -l words (commandline -opc)
    set -l asked $words[1]
    # Options aside; files among the words change nothing about the help of a verb.
    for word in $words[2..-1]
        string match -q -- '-*' $word; or set -a asked $word
    end
    $asked --help 2>/dev/null | awk '
        /^[A-Z][a-z ]*:$/ { listed = ($1 == "Options:" || $1 == "Subcommands:"); next }
        listed && /^  [-a-z]/ { n = split($1, names, ","); for (i = 1; i <= n; i++) { sub(/[{:=].*/, "", names[i]); print names[i] } }'
end

complete -c odomcalibctl -a '(__odomcalibctl_words)'
