s#Net-(\([A-Za-z0-9-]*\))#Net-_\1_#g
