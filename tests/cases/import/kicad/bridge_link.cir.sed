s#NCHAN (\(.*\))#NCHAN \1#
