//! Streams that meshoptimizer's own encoder made, and what its decoder makes of them (`vectors.txt`).

use super::Mode;
use base64::{Engine, engine::general_purpose::STANDARD};

struct Vector {
    name: String,
    mode: Mode,
    count: usize,
    stride: usize,
    stream: Vec<u8>,
    expected: String,
}

/// Lines of name, mode, filter, count, stride, the stream, and the decoded bytes or `#` and their FNV-1a hash.
fn vectors() -> Vec<Vector> {
    let line = |line: &str| {
        let words: Vec<&str> = line.split(' ').collect();
        let [name, mode, filter, count, stride, stream, expected] = words[..] else { panic!("{line}") };
        Vector {
            name: name.to_owned(),
            mode: Mode::of(mode, Some(filter)).unwrap(),
            count: count.parse().unwrap(),
            stride: stride.parse().unwrap(),
            stream: STANDARD.decode(stream).unwrap(),
            expected: expected.to_owned(),
        }
    };
    include_str!("vectors.txt").lines().map(line).collect()
}

fn hash(bytes: &[u8]) -> u64 {
    let step = |hash: u64, &byte: &u8| (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, step)
}

#[test]
fn streams_of_the_reference_encoder() {
    for Vector { name, mode, count, stride, stream, expected } in vectors() {
        let decoded = mode.decode(&stream, count, stride).unwrap_or_else(|error| panic!("{name}: {error}"));
        match expected.strip_prefix('#') {
            Some(expected) => assert_eq!(format!("{:016x}", hash(&decoded)), expected, "{name}"),
            None => {
                // Filters may differ by one unit.
                let expected = STANDARD.decode(expected).unwrap();
                assert_eq!(decoded.len(), expected.len(), "{name}");
                let units = |bytes: &[u8]| -> Vec<i32> {
                    match stride {
                        4 => bytes.iter().map(|&b| i32::from(b as i8)).collect(),
                        _ => bytes.chunks(2).map(|b| i32::from(i16::from_le_bytes([b[0], b[1]]))).collect(),
                    }
                };
                for (got, wanted) in units(&decoded).into_iter().zip(units(&expected)) {
                    assert!((got - wanted).abs() <= 1, "{name}: {got} instead of {wanted}");
                }
            }
        }
    }
}

#[test]
fn broken_streams_are_errors() {
    for Vector { name, mode, count, stride, stream, .. } in vectors() {
        for length in 0..stream.len() {
            assert!(mode.decode(&stream[..length], count, stride).is_err(), "{name} cut at {length}");
        }
        let longer = [&stream[..], &[0]].concat();
        assert!(mode.decode(&longer, count, stride).is_err(), "{name}");
        // Whatever a changed byte does, it does it without a panic.
        for at in 0..stream.len() {
            let mut changed = stream.clone();
            for value in [0, 0xff, changed[at] ^ 1, changed[at] ^ 0x80] {
                changed[at] = value;
                let _ = mode.decode(&changed, count, stride);
            }
        }
        for (count, stride) in
            [(count, 0), (count, 3), (count, 260), (count, usize::MAX), (usize::MAX, stride)]
        {
            assert!(mode.decode(&stream, count, stride).is_err(), "{name}");
        }
    }
    assert!(Mode::of("LINES", None).is_err() && Mode::of("ATTRIBUTES", Some("x")).is_err());
}
