//! What is undone after mode 0, element by element (appendix B of the extension).

/// The way in which values were made easier to compress.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::load::gltf) enum Filter {
    None,
    Octahedral,
    Quaternion,
    Exponential,
    Colour,
}

impl Filter {
    /// True when elements of so many bytes can have it.
    pub(super) fn fits(self, stride: usize) -> bool {
        match self {
            Self::None | Self::Exponential => true,
            Self::Octahedral | Self::Colour => stride == 4 || stride == 8,
            Self::Quaternion => stride == 8,
        }
    }

    pub(super) fn apply(self, data: &mut [u8], stride: usize) {
        match self {
            Self::None => {}
            Self::Exponential => data.as_chunks_mut().0.iter_mut().for_each(exponential),
            Self::Quaternion => shorts(data, |v| quaternion(v.map(|x| x as i16)).map(|x| x as u16)),
            Self::Octahedral if stride == 4 => {
                bytes(data, |v| octahedral(v.map(|x| f32::from(x as i8)), 127.0).map(|x| x as i8 as u8));
            }
            Self::Octahedral => {
                shorts(data, |v| {
                    octahedral(v.map(|x| f32::from(x as i16)), 32_767.0).map(|x| x as i16 as u16)
                });
            }
            Self::Colour if stride == 4 => bytes(data, |v| {
                let [y, co, cg, a] = v;
                let signed = |x: u8| i32::from(x as i8);
                colour(i32::from(y), signed(co), signed(cg), i32::from(a), 255.0).map(|x| x as u8)
            }),
            Self::Colour => shorts(data, |v| {
                let [y, co, cg, a] = v;
                let signed = |x: u16| i32::from(x as i16);
                colour(i32::from(y), signed(co), signed(cg), i32::from(a), 65_535.0).map(|x| x as u16)
            }),
        }
    }
}

fn bytes(data: &mut [u8], change: impl Fn([u8; 4]) -> [u8; 4]) {
    data.as_chunks_mut::<4>().0.iter_mut().for_each(|element| *element = change(*element));
}

fn shorts(data: &mut [u8], change: impl Fn([u16; 4]) -> [u16; 4]) {
    for element in data.as_chunks_mut::<8>().0 {
        let (raw, _) = element.as_chunks::<2>();
        let changed = change([raw[0], raw[1], raw[2], raw[3]].map(u16::from_le_bytes));
        element.as_chunks_mut::<2>().0.iter_mut().zip(changed).for_each(|(raw, x)| *raw = x.to_le_bytes());
    }
}

/// Unit vectors on an octahedron. The third number is what 1 is; the fourth stays.
fn octahedral([x, y, one, rest]: [f32; 4], max: f32) -> [f32; 4] {
    let (x, y) = (x / one, y / one);
    let z = 1.0 - x.abs() - y.abs();
    let fold = z.min(0.0);
    let (x, y) = (x - fold.copysign(x), y - fold.copysign(y));
    let scale = max / (x * x + y * y + z * z).sqrt();
    [(x * scale).round(), (y * scale).round(), (z * scale).round(), rest]
}

/// Rotations without their largest component; which one it is stands in the fourth number's lowest bits, above them what 1 is.
fn quaternion(v: [i16; 4]) -> [i16; 4] {
    let scale = std::f32::consts::FRAC_1_SQRT_2 / f32::from(v[3] | 3);
    let [x, y, z] = [v[0], v[1], v[2]].map(|x| f32::from(x) * scale);
    let w = (1.0 - x * x - y * y - z * z).max(0.0).sqrt();
    let largest = (v[3] & 3) as usize;
    let mut out = [0; 4];
    for (k, value) in [w, x, y, z].into_iter().enumerate() {
        out[(largest + k) % 4] = (value * 32_767.0).round() as i16;
    }
    out
}

/// Floats as 24 bits times a power of two.
fn exponential(raw: &mut [u8; 4]) {
    let bits = i32::from_le_bytes(*raw);
    let (exponent, mantissa) = (bits >> 24, (bits << 8) >> 8);
    let power = f64::from_bits(((1023 + i64::from(exponent)) as u64) << 52);
    // Both factors and their product are exact in f64; the one rounding is to f32.
    *raw = ((f64::from(mantissa) * power) as f32).to_le_bytes();
}

/// YCoCg to RGB. How wide numbers are is told by the highest bit of the alpha.
fn colour(y: i32, co: i32, cg: i32, a: i32, max: f32) -> [f32; 4] {
    let all = match a {
        0 => 1,
        _ => (2 << a.ilog2()) - 1,
    };
    let alpha = a & (all >> 1);
    let scale = max / all as f32;
    [y + co - cg, y + cg, y - co - cg, alpha << 1 | alpha & 1].map(|x| (x as f32 * scale).round())
}
