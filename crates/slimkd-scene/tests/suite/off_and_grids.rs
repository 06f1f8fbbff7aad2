//! OFF files and grids of heights.

use slimkd_scene::{Format, LoadError, LoadOptions, Origin, WarningKind, load_bytes, load_bytes_with};

#[test]
fn off_in_every_dress() {
    let body = "4 2 0\n0 0 0\n1 0 0 # a comment\n\n1 1 0\n0 1 0\n3 0 1 2 255 0 0\n3 0 2 3 0.0 0.5 1.0 1.0\n";
    for text in [format!("OFF\n{body}"), format!("OFF {body}"), format!("OFF{body}"), body.to_owned()] {
        for text in [text.clone(), text.replace('\n', "\r\n"), text.replace('\n', "\r")] {
            let scene = load_bytes(Format::Off, text.as_bytes()).unwrap();
            assert_eq!(scene.mesh.triangles(), [[0, 1, 2], [0, 2, 3]]);
            assert_eq!(scene.face_colours, [[255, 0, 0, 255], [0, 128, 255, 255]]);
        }
    }
    let coloured = "COFF\n3 1 0\n0 0 0 255 0 0 255\n1 0 0 0 255 0 255\n0 1 0 0 0 255 128\n3 0 1 2\n";
    let scene = load_bytes(Format::Off, coloured.as_bytes()).unwrap();
    assert_eq!(scene.colours.unwrap().values, [[255, 0, 0, 255], [0, 255, 0, 255], [0, 0, 255, 128]]);
    let concave = "OFF\n4 2 0\n0 0 0\n4 0 0\n1 1 0\n0 4 0\n4 0 1 2 3\n2 0 1\n";
    let scene = load_bytes(Format::Off, concave.as_bytes()).unwrap();
    assert_eq!((scene.mesh.len(), scene.warnings.len()), (2, 1));
    assert!(scene.mesh.triangles().iter().all(|corners| corners.contains(&2) && corners.contains(&0)));
}

#[test]
fn broken_off_files_are_errors() {
    for text in [
        "OFF",
        "OFF\n3 1 0\n0 0 0\n",
        "OFF\n1 1 0\n0 0 0\n3 0 0 1\n",
        "OFF\n999999999999 1 0\n",
        "nOFF\n3\n",
        "OFF BINARY\n",
    ] {
        let error = load_bytes(Format::Off, text.as_bytes()).unwrap_err();
        assert!(
            matches!(error, LoadError::Invalid { .. } | LoadError::Unsupported { .. }),
            "{text}: {error}"
        );
    }
}

const GRID: &str =
    "ncols 3\nnrows 2\nxllcorner 10\nyllcorner 20\ncellsize 2\nNODATA_value -9999\n1 2 -9999\n4 5 6\n";

#[test]
fn ascii_grids() {
    let scene = load_bytes(Format::AsciiGrid, GRID.as_bytes()).unwrap();
    assert_eq!(scene.mesh.vertices()[0], [11.0, 23.0, 1.0]);
    assert_eq!(scene.mesh.vertices()[5], [15.0, 21.0, 6.0]);
    // The square with the missing height is left out.
    assert_eq!(scene.mesh.triangles(), [[0, 3, 4], [0, 4, 1]]);
    let centre = GRID.replace("corner", "center");
    assert_eq!(
        load_bytes(Format::AsciiGrid, centre.as_bytes()).unwrap().mesh.vertices()[3],
        [10.0, 20.0, 4.0]
    );
    let far = GRID.replace("xllcorner 10", "XLLCORNER 528980");
    assert!(load_bytes(Format::AsciiGrid, far.as_bytes()).unwrap().warnings.is_empty());
    let none = LoadOptions::new().origin(Origin::None);
    let warnings = load_bytes_with(Format::AsciiGrid, far.as_bytes(), &none).unwrap().warnings;
    assert_eq!(warnings[0].kind, WarningKind::Precision);
    let wrong = [
        GRID.replace("5 6", "5"),
        GRID.replace("5 6", "5 6 7"),
        GRID.replace("ncols 3", "ncols -1"),
        GRID.replace("nrows 2", "nrows 4000000000"),
    ];
    for text in wrong {
        assert!(
            matches!(load_bytes(Format::AsciiGrid, text.as_bytes()), Err(LoadError::Invalid { .. })),
            "{text}"
        );
    }
}

fn npy(descr: &str, order: &str, shape: &str, data: &[u8]) -> Vec<u8> {
    let header = format!("{{'descr': '{descr}', 'fortran_order': {order}, 'shape': {shape}, }}\n");
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.as_bytes());
    bytes.extend(data);
    bytes
}

#[test]
fn numpy_arrays() {
    let rows = [[1f32, 2.0, 3.0], [4.0, 5.0, f32::NAN]];
    let little: Vec<u8> = rows.iter().flatten().flat_map(|z| z.to_le_bytes()).collect();
    let big: Vec<u8> = rows.iter().flatten().flat_map(|z| f64::from(*z).to_be_bytes()).collect();
    let columns: Vec<u8> = (0..3).flat_map(|c| rows.map(|row| row[c])).flat_map(f32::to_le_bytes).collect();
    for bytes in [
        npy("<f4", "False", "(2, 3)", &little),
        npy(">f8", "False", "(2, 3)", &big),
        npy("<f4", "True", "(2, 3)", &columns),
    ] {
        let scene = load_bytes(Format::Npy, &bytes).unwrap();
        assert_eq!(scene.mesh.vertices()[..2], [[0.0, 1.0, 1.0], [1.0, 1.0, 2.0]]);
        assert_eq!(scene.mesh.vertices()[3], [0.0, 0.0, 4.0]);
        assert_eq!(scene.mesh.triangles(), [[0, 3, 4], [0, 4, 1]]);
    }
    let bytes = npy("|u1", "False", "(2, 2)", &[1, 2, 3, 4]);
    assert_eq!(load_bytes(Format::Npy, &bytes).unwrap().mesh.len(), 2);
    for bytes in [
        npy("<f4", "False", "(2, 4)", &little),
        npy("<f4", "False", "(6,)", &little),
        npy("<c8", "False", "(1, 3)", &little),
        npy("<f4", "False", "(18446744073709551615, 4)", &little),
        b"\x93NUMPY\x01\x00\xff\xff".to_vec(),
        b"\x93NUMPY".to_vec(),
    ] {
        assert!(matches!(load_bytes(Format::Npy, &bytes), Err(LoadError::Invalid { .. })));
    }
}
