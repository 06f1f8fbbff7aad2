//! How large trees are.

use super::scene::{METHODS, MIB};
use super::{SceneJson, Table, row};
use crate::basics::number::{Json, Number};

/// Nodes by kind.
pub fn nodes(scene: &SceneJson<'_>) -> Table {
    let mut table = Table::new(
        format!("{}-nodes", scene.slug()),
        "Nodes by kind",
        "A T-inner node holds one triangle that most leaves below would repeat.",
        &["tree", "inner", "T-inner", "leaf", "total"],
    );
    for (index, name) in scene.trees().into_iter().enumerate() {
        let count = |kind: &str| scene.tree(index, &format!("/shape/nodes/{kind}"));
        let (inner, t_inner, leaf) = (count("inner"), count("t_inner"), count("leaf"));
        table.ours(row![name, inner.clone(), t_inner.clone(), leaf.clone(), inner + t_inner + leaf]);
    }
    for (method, preset) in METHODS {
        let Some(at) = scene.published_row("tree_size", Some(method)) else { continue };
        let count = |kind: &str| scene.json.number(&format!("{at}/{kind}"));
        let (inner, t_inner, leaf) = (count("inner_nodes"), count("t_inner_nodes"), count("leaf_nodes"));
        let name = format!("{preset}, {}", scene.published_label());
        table.published(row![name, inner.clone(), t_inner.clone(), leaf.clone(), inner + t_inner + leaf]);
    }
    table
}

/// Triangle indices by mode, and memory.
pub fn references(scene: &SceneJson<'_>) -> Table {
    let mut table = Table::new(
        format!("{}-references", scene.slug()),
        "Indices to triangles, and memory",
        "Indices of the leaves by how they are written. The tree is everything beside the bare indexed mesh. Saved: against \
         standard.",
        &[
            "tree",
            "4-byte",
            "2-byte",
            "coded",
            "all in leaves",
            "T-references",
            "tree, MiB",
            "saved, %",
            "B/triangle",
        ],
    );
    let base = scene.tree(0, "/shape/bytes/tree");
    for (index, name) in scene.trees().into_iter().enumerate() {
        let count = |kind: &str| scene.tree(index, &format!("/shape/references/{kind}"));
        let (wide, narrow, other) = (count("leaf_4byte"), count("leaf_2byte"), count("leaf_other"));
        let bytes = scene.tree(index, "/shape/bytes/tree");
        let all = wide.clone() + narrow.clone() + other.clone();
        table.ours(row![
            name,
            wide,
            narrow,
            other,
            all,
            count("t"),
            (bytes.clone() / MIB.into(), 2),
            (bytes.saved_of(&base), 1),
            (bytes / scene.number("/triangles"), 2),
        ]);
    }
    for (method, preset) in METHODS {
        let Some(at) = scene.published_row("tree_size", Some(method)) else { continue };
        let number = |key: &str| scene.json.number(&format!("{at}/{key}"));
        let (wide, narrow, mib) = (number("indices_4byte"), number("indices_2byte"), number("memory_mib"));
        let standard = scene.published_row("tree_size", Some("standard")).unwrap_or_default();
        let standard = scene.json.number(&format!("{standard}/memory_mib"));
        table.published(row![
            format!("{preset}, {}", scene.published_label()),
            wide.clone(),
            narrow.clone(),
            "",
            wide + narrow,
            number("t_inner_nodes"),
            (mib.clone(), 2),
            (mib.saved_of(&standard), 1),
            (mib * MIB.into() / number("triangles"), 2),
        ]);
    }
    table
}

/// Trees beside the geometry.
pub fn geometry(scene: &SceneJson<'_>) -> Table {
    let mut table = Table::new(
        format!("{}-geometry", scene.slug()),
        "Tree size against geometry size",
        "Geometry is the indexed mesh: 12 bytes a vertex and 12 a triangle.",
        &["tree", "geometry, MiB", "tree, MiB", "tree / geometry", "both, B/triangle"],
    );
    let mesh = scene.number("/mesh_bytes");
    for (index, name) in scene.trees().into_iter().enumerate() {
        let bytes = scene.tree(index, "/shape/bytes/tree");
        table.ours(row![
            name,
            (mesh.clone() / MIB.into(), 2),
            (bytes.clone() / MIB.into(), 2),
            (bytes.clone() / mesh.clone(), 2),
            ((bytes + mesh.clone()) / scene.number("/triangles"), 1),
        ]);
    }
    if let Some(at) = scene.published_row("geometry_size", None) {
        let number = |key: &str| scene.json.number(&format!("{at}/{key}"));
        let (mesh, tree) = (number("geometry_mib"), number("standard_tree_mib"));
        table.published(row![
            format!("standard, {}", scene.published_label()),
            (mesh.clone(), 2),
            (tree.clone(), 2),
            (tree.clone() / mesh.clone(), 2),
            ((tree + mesh) * MIB.into() / (Number::from(1000.0) * number("triangles_k")), 1),
        ]);
    }
    table
}

/// The very large scene, ours and theirs.
pub fn very_large(json: Json<'_>) -> Table {
    let mut table = Table::new(
        "very-large",
        "The very large scene",
        "Slower: mean over the views on the fewest threads measured, against standard; one in the paper. Its scene is not \
         public; ours is the built-in power plant.",
        &["scene", "triangles, M", "tree", "tree, MiB", "saved, %", "slower, %"],
    );
    let scenes = json.list("/scenes").iter().enumerate().filter(|(_, scene)| scene["very_large"] == true);
    for (index, _) in scenes {
        let scene = SceneJson { json, index };
        let base = scene.tree(0, "/shape/bytes/tree");
        for (tree, name) in scene.trees().into_iter().enumerate() {
            let bytes = scene.tree(tree, "/shape/bytes/tree");
            table.ours(row![
                scene.name(),
                (scene.number("/triangles") / 1e6.into(), 1),
                name,
                (bytes.clone() / MIB.into(), 1),
                (bytes.saved_of(&base), 1),
                (super::speed::mean_slower(&scene, tree), 1),
            ]);
        }
    }
    if table.rows.is_empty() {
        return table;
    }
    for (row, (_, preset)) in METHODS.iter().enumerate() {
        let number = |row: usize, key: &str| json.number(&format!("/published/very_large_scene/{row}/{key}"));
        table.published(row![
            "published",
            (number(row, "triangles_m"), 1),
            *preset,
            (number(row, "tree_mib"), 1),
            (number(row, "tree_mib").saved_of(&number(0, "tree_mib")), 1),
            (number(row, "frame_rate_loss_percent_1_thread"), 1),
        ]);
    }
    table
}
