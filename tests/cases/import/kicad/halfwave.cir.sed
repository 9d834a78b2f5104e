s#"C:/Users/anna/Documents/kicad/#"#
