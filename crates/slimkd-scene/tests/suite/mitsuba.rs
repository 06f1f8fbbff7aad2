//! Mitsuba's scenes: shapes, transforms, groups, materials, parameters, files beside the scene, and hostile ones.

use slimkd_scene::{
    Format, Light, LoadError, LoadOptions, Scene, UpAxis, WarningKind, load, load_bytes, load_with,
};
use std::{fs, io::Write};

fn xml(body: &str) -> Result<Scene, LoadError> {
    load_bytes(
        Format::Mitsuba,
        format!("<?xml version=\"1.0\"?><scene version=\"3.0.0\">{body}</scene>").as_bytes(),
    )
}

fn scene(body: &str) -> Scene {
    xml(body).unwrap_or_else(|error| panic!("{body}: {error}"))
}

fn close(a: [f32; 3], b: [f32; 3]) {
    assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-5), "{a:?} {b:?}");
}

/// Twice the area, with the sign by which triangles face away from `inside`.
fn faces_outwards(scene: &Scene, inside: [f64; 3]) -> bool {
    (0..scene.mesh.len() as u32).all(|id| {
        let [a, b, c] = scene.mesh.corners(id).map(|p| [0, 1, 2].map(|k| f64::from(p[k]) - inside[k]));
        let n = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
        n.iter().zip(c).map(|(n, c)| n * c).sum::<f64>() > 0.0
    })
}

#[test]
fn shapes_by_numbers() {
    let square = scene(r#"<shape type="rectangle"/>"#);
    assert_eq!(square.mesh.vertices(), [[-1., -1., 0.], [1., -1., 0.], [1., 1., 0.], [-1., 1., 0.]]);
    assert_eq!(square.mesh.triangles(), [[0, 1, 2], [2, 3, 0]]);
    let cube = scene(r#"<shape type="cube"/>"#);
    assert_eq!(cube.mesh.len(), 12);
    assert!(faces_outwards(&cube, [0.0; 3]) && cube.warnings.is_empty());
    let ball = scene(
        r#"<shape type="sphere"><point name="center" x="1" y="2" z="3"/><float name="radius" value="0.5"/></shape>"#,
    );
    assert_eq!(ball.mesh.len(), 2208);
    assert!(faces_outwards(&ball, [1.0, 2.0, 3.0]));
    assert_eq!(ball.warnings[0].count(), Some((1, 1)));
    for vertex in ball.mesh.vertices() {
        let distance = (0..3).map(|k| (vertex[k] - [1.0, 2.0, 3.0][k]).powi(2)).sum::<f32>().sqrt();
        assert!((distance - 0.5).abs() < 1e-6);
    }
    let pipe = scene(
        r#"<shape type="cylinder"><point name="p0" value="0, 0, 1"/><point name="p1" value="0 0 3"/><float name="radius" value="2"/></shape>"#,
    );
    assert_eq!(pipe.mesh.len(), 96);
    assert!(pipe.mesh.vertices().iter().all(|v| v[2] == 1.0 || v[2] == 3.0));
    let outwards = pipe.normals.as_ref().unwrap().values.iter().zip(pipe.mesh.vertices());
    assert!(outwards.into_iter().all(|(n, v)| n[0] * v[0] + n[1] * v[1] > 1.99));
    assert!(faces_outwards(&pipe, [0.0, 0.0, 2.0]));
    let faceted = scene(r#"<shape type="disk"><boolean name="face_normals" value="true"/></shape>"#);
    assert!(faceted.normals.is_none());
    let disc = scene(r#"<shape type="disk"/>"#);
    assert_eq!(disc.mesh.len(), 48);
    assert!(faces_outwards(&disc, [0.0, 0.0, -1.0]));
}

#[test]
fn transforms_in_their_order() {
    let corner = |steps: &str| {
        let body =
            format!(r#"<shape type="rectangle"><transform name="to_world">{steps}</transform></shape>"#);
        scene(&body).mesh.vertices()[2]
    };
    close(corner(r#"<scale value="2"/><translate x="1" z="5"/>"#), [3.0, 2.0, 5.0]);
    close(corner(r#"<translate value="1, 0, 5"/><scale x="2" y="3"/>"#), [4.0, 3.0, 5.0]);
    close(corner(r#"<rotate z="1" angle="90"/>"#), [-1.0, 1.0, 0.0]);
    close(corner(r#"<rotate value="0 2 0" angle="90"/>"#), [0.0, 1.0, -1.0]);
    close(corner(r#"<matrix value="1 0 0 7  0 1 0 8  0 0 1 9  0 0 0 1"/>"#), [8.0, 9.0, 9.0]);
    close(corner(r#"<matrix value="0,1,0, 2,0,0, 0,0,1"/>"#), [1.0, 2.0, 0.0]);
    // The rectangle looks from (0, 0, 5) down to the origin: its +z is −z of the world, its +x −x.
    close(corner(r#"<lookat origin="0,0,5" target="0,0,0" up="0,1,0"/>"#), [-1.0, 1.0, 5.0]);
    // As versions before 2 wrote it.
    let old = r#"<shape type="rectangle"><transform name="toWorld"><lookAt origin="0,0,5" target="0,0,0" up="0,1,0"/></transform></shape>"#;
    close(scene(old).mesh.vertices()[2], [-1.0, 1.0, 5.0]);
    for wrong in [
        r#"<scale value="1 2"/>"#,
        r#"<rotate angle="3"/>"#,
        r#"<matrix value="1 2 3"/>"#,
        r#"<lookat origin="0,0,0" target="0,0,0"/>"#,
        r#"<translate x="$far"/>"#,
    ] {
        let body =
            format!(r#"<shape type="rectangle"><transform name="to_world">{wrong}</transform></shape>"#);
        assert!(matches!(xml(&body), Err(LoadError::Invalid { .. })), "{wrong}");
    }
}

#[test]
fn groups_are_drawn_where_their_instances_are() {
    let body = r#"
        <shape type="shapegroup" id="leaves">
            <shape type="rectangle"><ref id="green"/></shape>
            <shape type="cube"/>
        </shape>
        <bsdf type="diffuse" id="green"><rgb name="reflectance" value="0.1 0.6 0.2"/></bsdf>
        <shape type="instance"><ref id="leaves"/><transform name="to_world"><translate x="10"/></transform></shape>
        <shape type="instance"><ref id="leaves"/><transform name="to_world"><scale x="-1"/></transform></shape>"#;
    let scene = scene(body);
    assert_eq!(scene.mesh.len(), 28);
    assert_eq!(scene.mesh.corners(0)[0], [9.0, -1.0, 0.0]);
    assert_eq!(scene.material(0).name, "green");
    assert_eq!(scene.material(2).name, "");
    // Mirrored, the square is still seen from +z.
    let [a, b, c] = scene.mesh.corners(14);
    assert!((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]) > 0.0);
    assert!(xml(r#"<shape type="instance"/>"#).is_err());
    let nested = r#"<shape type="shapegroup" id="a"><shape type="instance"><ref id="a"/></shape></shape><shape type="instance"><ref id="a"/></shape>"#;
    let nested = xml(nested).unwrap();
    assert_eq!((nested.mesh.len(), nested.warnings[0].kind), (0, WarningKind::Ignored));
}

#[test]
fn materials_as_far_as_they_go() {
    let body = r##"
        <bsdf type="twosided" id="wall"><bsdf type="diffuse"><rgb name="reflectance" value="#ff0000"/></bsdf></bsdf>
        <bsdf type="dielectric" id="glass"><string name="intIOR" value="diamond"/><string name="ext_ior" value="vacuum"/></bsdf>
        <bsdf type="conductor" id="mirror"/>
        <bsdf type="roughplastic" id="plastic"><spectrum name="diffuse_reflectance" value="400:0.2, 700:0.4"/></bsdf>
        <bsdf type="strange" id="strange"/>
        <shape type="rectangle"><ref id="wall"/></shape>
        <shape type="rectangle"><ref name="bsdf" id="glass"/></shape>
        <shape type="rectangle"><ref id="mirror"/></shape>
        <shape type="rectangle"><ref id="plastic"/></shape>
        <shape type="rectangle"><ref id="strange"/></shape>
        <shape type="rectangle"><ref id="wall"/><emitter type="area"><rgb name="radiance" value="3"/></emitter></shape>
        <shape type="rectangle"/>"##;
    let scene = scene(body);
    let of = |shape: u32| scene.material(2 * shape);
    assert_eq!(of(0).diffuse.to_array(), [1.0, 0.0, 0.0]);
    assert_eq!((of(1).transmission, of(1).ior), (1.0, 2.419));
    assert_eq!(of(2).reflection, 1.0);
    assert!((of(3).diffuse.x - 0.3).abs() < 1e-6 && of(3).reflection == 0.0);
    assert_eq!(of(4).diffuse.to_array(), [0.5; 3]);
    assert_eq!((of(5).emission.to_array(), of(5).diffuse.x), ([3.0; 3], 1.0));
    assert_eq!(scene.materials.len(), 7);
    assert_eq!(scene.warnings.len(), 1);
    assert!(scene.warnings[0].text().contains("strange"), "{}", scene.warnings[0]);
}

#[test]
fn lights_and_cameras() {
    let body = r#"
        <integrator type="path"/>
        <emitter type="point"><point name="position" x="1" y="2" z="3"/><rgb name="intensity" value="5"/></emitter>
        <emitter type="directional"><vector name="direction" x="0" y="0" z="-1"/></emitter>
        <emitter type="envmap"><string name="filename" value="sky.exr"/></emitter>
        <sensor type="perspective"><float name="fov" value="90"/><string name="fov_axis" value="y"/>
            <transform name="to_world"><lookat origin="0 0 9" target="0 0 0" up="0 1 0"/></transform>
            <film type="hdrfilm"><integer name="width" value="100"/><integer name="height" value="50"/></film></sensor>
        <sensor type="irradiancemeter"/>
        <shape type="rectangle"/><shape type="hair"/>"#;
    let scene = scene(body);
    assert!(matches!(scene.lights[..], [Light::Point { .. }, Light::Directional { .. }]));
    close(scene.cameras[0].eye.to_array(), [0.0, 0.0, 9.0]);
    close(scene.cameras[0].target.to_array(), [0.0, 0.0, 8.0]);
    assert!((scene.cameras[0].fov - 90.0).abs() < 1e-4);
    assert_eq!(scene.up, Some(UpAxis::Y));
    let counts: Vec<_> = scene.warnings.iter().map(|warning| warning.count()).collect();
    assert_eq!(counts, [Some((1, 2)), Some((1, 3)), Some((1, 2))]);
}

#[test]
fn parameters_and_their_defaults() {
    let body = r#"<default name="w" value="3"/><default name="wide" value="4"/><default name="w" value="9"/>
        <default name="both" value="$w 1 1"/>
        <integrator type="path"><integer name="max_depth" value="$unknown"/></integrator>
        <shape type="rectangle"><transform name="to_world"><scale value="$both"/><translate x="$wide"/></transform></shape>"#;
    close(scene(body).mesh.vertices()[2], [7.0, 1.0, 0.0]);
}

/// Twice as long with each line: refused or cut, never gigabytes.
#[test]
fn bombs_of_parameters_and_entities() {
    let mut body = String::from(r#"<default name="a0" value="aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa"/>"#);
    for k in 0..64 {
        body += &format!(r#"<default name="a{}" value="$a{k}$a{k}"/>"#, k + 1);
    }
    assert!(matches!(xml(&body), Err(LoadError::OutOfProportion { .. })));
    let bomb =
        r#"<!DOCTYPE s [<!ENTITY a "lol"><!ENTITY b "&a;&a;&a;&a;">]><scene><shape type="&b;"/></scene>"#;
    assert!(matches!(load_bytes(Format::Mitsuba, bomb.as_bytes()), Err(LoadError::Invalid { .. })));
    let harmless =
        r#"<!DOCTYPE s [<!ENTITY a "lol">]><scene>&a;<shape type="rectangle" id="&lt;&#65;"/></scene>"#;
    assert_eq!(load_bytes(Format::Mitsuba, harmless.as_bytes()).unwrap().mesh.len(), 2);
    let deep = "<shape>".repeat(100_000);
    assert!(matches!(xml(&deep), Err(LoadError::Invalid { .. })));
    let many: String = (0..100).map(|k| format!(" a{k}=\"\"")).collect();
    assert!(matches!(xml(&format!("<shape{many}/>")), Err(LoadError::Invalid { .. })));
    let balls = r#"<shape type="instance"><ref id="g"/></shape>"#.repeat(20_000);
    let group = r#"<shape type="shapegroup" id="g"><shape type="sphere"/><shape type="sphere"/></shape>"#;
    assert!(matches!(xml(&format!("{group}{balls}")), Err(LoadError::OutOfProportion { .. })));
}

/// What is drawn again and again costs what it holds, and each BSDF is converted once.
#[test]
fn many_instances_of_much_that_is_no_triangle() {
    let nothing = "<string/>".repeat(20_000);
    let places = r#"<shape type="instance"><ref id="g"/></shape>"#.repeat(40_000);
    for shape in [
        format!(r#"<shape type="hair">{nothing}</shape>"#),
        format!(r#"<shape type="rectangle"><transform name="to_world">{nothing}</transform></shape>"#),
        nothing.clone(),
    ] {
        let loaded = xml(&format!(r#"<shape type="shapegroup" id="g">{shape}</shape>{places}"#));
        assert!(matches!(loaded, Err(LoadError::OutOfProportion { .. })));
    }
    let light = r#"<shape type="disk"><ref id="b"/><emitter type="area"/></shape>"#.repeat(1_000);
    let scene = scene(&format!(r#"<bsdf type="diffuse" id="b">{nothing}</bsdf>{light}"#));
    assert_eq!(scene.materials.len(), 1_000);
}

#[test]
fn broken_xml_is_an_error_with_its_line() {
    for (text, line) in [
        ("<scene>\n<shape type=\"cube\">\n</scene>", "line 3"),
        ("<scene>\n<shape type=cube/>\n</scene>", "line 2"),
        ("<scene>", "line 1"),
        ("<house/>", "line 1"),
        ("", "empty"),
        ("no xml", "line 1"),
        ("<scene/><scene/>", "line 1"),
        (
            "<scene>\n\n\n<shape type=\"sphere\"><float name=\"radius\" value=\"wide\"/></shape></scene>",
            "line 4",
        ),
    ] {
        let error = load_bytes(Format::Mitsuba, text.as_bytes()).unwrap_err().to_string();
        assert!(error.contains(line), "{text}: {error}");
    }
    assert!(load_bytes(Format::Mitsuba, b"<scene a='\xff'/>").is_err());
}

/// A mesh of one triangle as Mitsuba writes it; its positions are moved by `x`.
fn serialized(version: u16, is_double: bool, x: f32) -> Vec<u8> {
    let mut content = Vec::new();
    content.extend((0x0001u32 | if is_double { 0x2000 } else { 0x1000 }).to_le_bytes());
    if version == 4 {
        content.extend(b"part\0");
    }
    content.extend(3u64.to_le_bytes());
    content.extend(1u64.to_le_bytes());
    let corners = [[x, 0.0, 0.0], [x + 1.0, 0.0, 0.0], [x, 1.0, 0.0]];
    for number in corners.iter().flatten().chain([[0.0f32, 0.0, 1.0]; 3].iter().flatten()) {
        if is_double {
            content.extend(f64::from(*number).to_le_bytes())
        } else {
            content.extend(number.to_le_bytes())
        }
    }
    [0u32, 1, 2].iter().for_each(|corner| content.extend(corner.to_le_bytes()));
    let mut out = [0x041Cu16.to_le_bytes(), version.to_le_bytes()].concat();
    let mut encoder = flate2::write::ZlibEncoder::new(&mut out, flate2::Compression::default());
    encoder.write_all(&content).unwrap();
    encoder.finish().unwrap();
    out
}

fn serialized_file(version: u16, is_double: bool) -> Vec<u8> {
    let (mut out, mut places) = (Vec::new(), Vec::new());
    for k in 0..3u8 {
        places.push(out.len());
        out.extend(serialized(version, is_double, 10.0 * f32::from(k)));
    }
    for place in &places {
        if version == 3 {
            out.extend((*place as u32).to_le_bytes())
        } else {
            out.extend((*place as u64).to_le_bytes())
        }
    }
    out.extend(3u32.to_le_bytes());
    out
}

#[test]
fn serialized_meshes() {
    for (version, is_double) in [(3, false), (3, true), (4, false), (4, true)] {
        let file = serialized_file(version, is_double);
        let scene = load_bytes(Format::Serialized, &file).unwrap();
        assert_eq!(scene.mesh.triangles(), [[0, 1, 2], [3, 4, 5], [6, 7, 8]], "{version} {is_double}");
        assert_eq!(scene.mesh.corners(2)[0], [20.0, 0.0, 0.0]);
        assert_eq!(scene.normals.unwrap().values, [[0.0, 0.0, 1.0]; 9]);
        // Without the list there is one mesh.
        let alone = serialized(version, is_double, 5.0);
        assert_eq!(load_bytes(Format::Serialized, &alone).unwrap().mesh.corners(0)[1], [6.0, 0.0, 0.0]);
        for length in 0..file.len() {
            let _ = load_bytes(Format::Serialized, &file[..length]);
        }
    }
    let mut wrong = serialized(4, false, 0.0);
    wrong[2] = 9;
    assert!(matches!(load_bytes(Format::Serialized, &wrong), Err(LoadError::Invalid { .. })));
}

const PLY: &str = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
    element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";

fn shape(plugin: &str, file: &str, more: &str) -> String {
    format!(r#"<shape type="{plugin}"><string name="filename" value="{file}"/>{more}</shape>"#)
}

#[test]
fn files_beside_the_scene() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    fs::create_dir_all(at("model/meshes")).unwrap();
    fs::write(at("model/meshes/a.ply"), PLY).unwrap();
    fs::write(at("outside.ply"), PLY).unwrap();
    let obj = "mtllib none.mtl\nv 0 0 0\nv 4 0 0\nv 1 1 0\nv 0 4 0\nvt 0 0\nusemtl none\nf 1/1 2/1 3/1 4/1\n";
    fs::write(at("model/meshes/b.obj"), obj).unwrap();
    fs::write(at("model/meshes/c.serialized"), serialized_file(4, false)).unwrap();
    let part = r#"<scene version="3.0.0"><shape type="cube"/><include filename="more.xml"/></scene>"#;
    fs::write(at("model/meshes/part.xml"), part).unwrap();
    fs::write(at("model/meshes/more.xml"), r#"<scene><shape type="rectangle"/></scene>"#).unwrap();
    let write = |body: &str| {
        let path = at("model/scene.xml");
        fs::write(&path, format!(r#"<scene version="3.0.0">{body}</scene>"#)).unwrap();
        path
    };
    let all = [
        shape("ply", "meshes/a.ply", r#"<transform name="to_world"><translate x="5"/></transform>"#),
        shape("ply", "meshes\\a.ply", r#"<boolean name="flip_normals" value="true"/>"#),
        shape("obj", "meshes/b.obj", ""),
        shape("serialized", "meshes/c.serialized", r#"<integer name="shape_index" value="2"/>"#),
        shape("serialized", "meshes/c.serialized", r#"<integer name="shapeIndex" value="1"/>"#),
        r#"<include filename="meshes/part.xml"/>"#.to_owned(),
    ];
    let scene = load(write(&all.concat())).unwrap();
    assert_eq!(scene.mesh.len(), 1 + 1 + 2 + 1 + 1 + 12 + 2);
    assert_eq!(scene.mesh.corners(0)[0], [5.0, 0.0, 0.0]);
    assert_eq!(scene.mesh.triangles()[1], [3, 5, 4]);
    assert_eq!(scene.mesh.corners(4)[0], [20.0, 0.0, 0.0]);
    assert_eq!(scene.mesh.corners(5)[0], [10.0, 0.0, 0.0]);
    assert_eq!((scene.warnings.len(), scene.name.as_str()), (0, "scene"), "{:?}", scene.warnings);
    // Three parts have normals, two have none.
    let normals = scene.normals.as_ref().unwrap();
    assert!(normals.corners(0, scene.mesh.triangles()[0]).is_none());
    assert_eq!(normals.corners(4, scene.mesh.triangles()[4]), Some([[0.0, 0.0, 1.0]; 3]));

    for body in [
        shape("ply", "missing.ply", ""),
        shape("serialized", "meshes/c.serialized", r#"<integer name="shape_index" value="3"/>"#),
    ] {
        let error = load(write(&body)).unwrap_err().to_string();
        assert!(error.contains("line 1") && error.contains("shape file"), "{error}");
    }
    for name in ["../outside.ply", at("outside.ply").to_str().unwrap()] {
        let path = write(&shape("ply", name, ""));
        let error = load(&path).unwrap_err().to_string();
        assert!(error.contains("--allow-outside"), "{error}");
        let options = LoadOptions::new().allow_outside(true);
        assert_eq!(load_with(&path, &options, &slimkd::Progress::new()).unwrap().mesh.len(), 1);
    }
    let own = write(r#"<include filename="scene.xml"/><include filename="scene.xml"/>"#);
    assert!(matches!(load(&own), Err(LoadError::Invalid { .. } | LoadError::OutOfProportion { .. })));
    for name in ["/etc/passwd", "../../../../etc/passwd", "/dev/zero", "meshes"] {
        assert!(load(write(&format!(r#"<include filename="{name}"/>"#))).is_err(), "{name}");
    }
}
