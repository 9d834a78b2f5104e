s#{slash}#_#g
