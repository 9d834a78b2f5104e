s#/ac\b#/acx#g
