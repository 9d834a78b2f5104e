s#\bAC\b#ACX#g
