//! What a scene's loader warns of reaches the user: on stderr, in JSON, and as an error where that is asked for.

use crate::common::Tool;

const ODD: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2\nnonsense 1 2\n";

#[test]
fn warnings_are_printed_listed_hidden_and_made_errors() {
    let tool = Tool::new();
    tool.file("odd.obj", ODD);
    for command in ["build odd.obj", "inspect odd.obj"] {
        let json = tool.json(&format!("{command} --json"));
        let listed: Vec<&str> =
            json["warnings"].as_array().unwrap().iter().map(|warning| warning.as_str().unwrap()).collect();
        assert_eq!(listed.len(), 2, "{listed:?}");
        assert!(listed.iter().any(|warning| warning.starts_with("1 of 2 faces")), "{listed:?}");
        let shown = tool.ok(command).stderr;
        assert_eq!(shown.matches("warning: odd.obj: ").count(), 2, "{shown}");
        assert_eq!(tool.ok(&format!("{command} --quiet")).stderr, "");
        tool.fails(&format!("{command} --strict --quiet"), 1, &["odd.obj", "--strict"]);
    }
}
