s#"\.\./\.\./\.\./#"#
s#C:\\work\\models\\##
/nom.lib/d
/^\.PROBE64/d
/halfwave.net/s/.*/grep -v EXTERNAL halfwave.net/e
