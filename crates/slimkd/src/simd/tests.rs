//! Every instruction set that is here against plain arrays, operation by operation, bit by bit.

use super::{InstructionSet, Kernel, Scalar, Simd};

const LANES: usize = 16;

/// Values that break sloppy code.
const ODD: [f32; LANES] = [
    0.0,
    -0.0,
    1.0,
    -1.5,
    f32::INFINITY,
    f32::NEG_INFINITY,
    f32::NAN,
    f32::MIN_POSITIVE,
    1e-42,
    f32::MAX,
    3.0,
    0.1,
    -7.25e8,
    1.000_000_1,
    -1e-30,
    16_777_217.0,
];

/// Runs every operation and writes down what came out, as bits. A NaN's payload is nobody's promise.
struct Everything {
    shift: usize,
}

impl Kernel for Everything {
    type Output = Vec<u64>;

    #[inline(always)]
    fn run<S: Simd>(self, s: S) -> Vec<u64> {
        assert_eq!(S::WIDTH, LANES);
        let mut turned = ODD;
        turned.rotate_left(self.shift);
        let (a, b) = (s.load(&ODD), s.load(&turned));
        let words = |k: u32| std::array::from_fn::<u32, LANES, _>(|i| (i as u32).wrapping_mul(k) ^ k >> 3);
        let (u, v) = (s.load_u32(&words(0x9e37_79b9)), s.load_u32(&words(0x85eb_ca6b)));
        let mut out: Vec<u64> = Vec::new();

        for x in [a + b, a - b, a * b, a / b, s.larger(a, b), s.smaller(a, b), s.abs(a), s.f32s(0.3)] {
            put(s, x, &mut out);
        }
        let (wide_a, wide_b) = (s.widen(a), s.widen(b));
        let third = s.f64s(1.0 / 3.0);
        let masks = [
            s.lt(a, b),
            s.le(a, b),
            s.eq(a, b),
            s.lt_f64(wide_a, wide_b),
            s.eq_f64(wide_a, wide_b),
            s.eq_u32(u, s.u32s(0x9e37_79b9 >> 3)),
            s.lt_u32(u, v),
            s.mask(0xffff_a5c3),
        ];
        for m in masks {
            out.extend([u64::from(s.bits(m)), s.bits(!m).into(), s.any(m).into(), s.all(m | !m).into()]);
            put(s, s.select(m, a, b), &mut out);
            put_u32(s, s.select_u32(m, u, v), &mut out);
            let mut to = [0; LANES];
            let count = s.compress(m, u, &mut to);
            out.push(count as u64);
            out.extend(to[..count].iter().map(|&x| u64::from(x)));
        }
        assert!(!s.any(s.mask(0)) && s.all(s.mask(0xffff)));
        for x in [wide_a + third, wide_a - third * wide_b, wide_a / wide_b, wide_a * wide_a] {
            put(s, s.narrow(x), &mut out);
        }
        for x in [u + v, u - v, u & v, u | v, u ^ v, u << 3, u >> 9, u << 0, s.cast_u32(s.cast_f32(u))] {
            put_u32(s, x, &mut out);
        }
        let from = (v >> 3) & s.u32s(15);
        put(s, s.permute(a, from), &mut out);
        put_u32(s, s.permute_u32(u, from), &mut out);

        let records: [[f32; 8]; LANES] = std::array::from_fn(|i| std::array::from_fn(|k| (8 * i + k) as f32));
        for column in s.columns(&records) {
            put(s, column, &mut out);
        }

        let bytes: Vec<u8> = (0..256u32).map(|i| (i.wrapping_mul(97) >> 2) as u8).collect();
        // SAFETY: the largest place is 15 · 5 + 8 bytes, 15 · 8 + 16, 15 · 4 + 16; all lie in the 256 bytes.
        unsafe {
            put_u32(s, s.gather_u32::<4>(bytes.as_ptr(), from), &mut out);
            put(s, s.gather::<4>(bytes.as_ptr(), from), &mut out);
            let (low, high) = s.gather_pairs::<8>(bytes.as_ptr(), from);
            put_u32(s, low, &mut out);
            put_u32(s, high, &mut out);
            let (low, high) = s.gather_pairs::<1>(bytes.as_ptr(), from + (from << 2));
            put_u32(s, low, &mut out);
            put_u32(s, high, &mut out);
            for word in s.gather_rows::<4>(bytes.as_ptr(), from) {
                put_u32(s, word, &mut out);
            }
            let mut at = [0; LANES];
            s.store_u32(from << 3, &mut at);
            let (low, high) = s.load_pairs::<1>(bytes.as_ptr(), &at);
            let rows = s.load_rows(bytes.as_ptr(), &at);
            for word in [low, high].into_iter().chain(rows) {
                put_u32(s, word, &mut out);
            }
            let mut words = [7u64; 2 * LANES];
            let at: [u32; LANES] = std::array::from_fn(|i| 16 * ((5 * i + self.shift) % LANES) as u32);
            s.store_rows(words.as_mut_ptr().cast(), &at, [u, v, u ^ v, u + v]);
            out.extend(words);
        }
        let table = std::array::from_fn(|i| i as f32);
        put(s, s.pick(&table, v >> 3), &mut out);
        out
    }
}

#[inline(always)]
fn put<S: Simd>(s: S, x: S::F, out: &mut Vec<u64>) {
    let mut lanes = [0.0; LANES];
    s.store(x, &mut lanes);
    out.extend(lanes.map(|x| if x.is_nan() { u64::MAX } else { x.to_bits().into() }));
}

#[inline(always)]
fn put_u32<S: Simd>(s: S, x: S::U, out: &mut Vec<u64>) {
    let mut lanes = [0; LANES];
    s.store_u32(x, &mut lanes);
    out.extend(lanes.map(u64::from));
}

#[test]
fn every_instruction_set_computes_what_plain_arrays_do() {
    for shift in 0..LANES {
        let expected = Everything { shift }.run(Scalar);
        for set in InstructionSet::ALL.iter().filter(|set| set.is_available()) {
            let wanted = (*set != InstructionSet::Scalar).then_some(&expected);
            assert_eq!(set.run(Everything { shift }).as_ref(), wanted, "{} {shift}", set.name());
        }
    }
}

#[test]
fn min_and_max_pass_over_a_nan_in_front() {
    let (nan, one) = (Scalar.f32s(f32::NAN), Scalar.f32s(1.0));
    let first = |x| {
        let mut lanes = [0.0; LANES];
        Scalar.store(x, &mut lanes);
        lanes[0]
    };
    assert_eq!(first(Scalar.larger(nan, one)), 1.0);
    assert_eq!(first(Scalar.smaller(nan, one)), 1.0);
    assert!(first(Scalar.smaller(one, nan)).is_nan());
}
