s#"\(SCR\|POWER\)\.LIB"#"\L\1.lib"#
