// Arithmetic that no compiler may bend. WGSL lets drivers contract a·b + c, reorder sums and flush denormals; what passes
// `keep` is a bit pattern to them, because `zero` is known only when the kernel runs. Twin: twin/exact.rs.

fn keep(x: f32) -> f32 { return bitcast<f32>(bitcast<u32>(x) ^ params.zero); }

fn keep3(x: vec3<f32>) -> vec3<f32> { return bitcast<vec3<f32>>(bitcast<vec3<u32>>(x) ^ vec3<u32>(params.zero)); }

// A float's magnitude as mantissa · 2^exponent, the mantissa's bit 23 set. x must not be 0.
struct Magnitude { mantissa: u32, exponent: i32 }

fn magnitude(x: f32) -> Magnitude {
    let bits = bitcast<u32>(x) & 0x7fffffffu;
    let exponent = bits >> 23u;
    let fraction = bits & 0x7fffffu;
    if exponent == 0u {
        let shift = countLeadingZeros(fraction) - 8u;
        return Magnitude(fraction << shift, 1 - i32(shift));
    }
    return Magnitude(fraction | 0x800000u, i32(exponent));
}

// |a·b| exactly: two 24-bit halves, bit 23 of the upper one set.
struct Product { upper: u32, lower: u32, exponent: i32 }

fn product(a: f32, b: f32) -> Product {
    let x = magnitude(a);
    let y = magnitude(b);
    let xh = x.mantissa >> 12u;
    let xl = x.mantissa & 0xfffu;
    let yh = y.mantissa >> 12u;
    let yl = y.mantissa & 0xfffu;
    let low = xl * yl;
    let middle = (low >> 12u) + xh * yl + xl * yh;
    var upper = xh * yh + (middle >> 12u);
    var lower = (low & 0xfffu) | ((middle & 0xfffu) << 12u);
    var exponent = x.exponent + y.exponent;
    if (upper & 0x800000u) == 0u {
        upper = (upper << 1u) | (lower >> 23u);
        lower = (lower << 1u) & 0xffffffu;
        exponent -= 1;
    }
    return Product(upper, lower, exponent);
}

fn is_zero(x: f32) -> bool { return (bitcast<u32>(x) & 0x7fffffffu) == 0u; }

// Sign of a·b: -1, 0, 1.
fn sign_of_product(a: f32, b: f32) -> i32 {
    if is_zero(a) || is_zero(b) { return 0; }
    return select(1, -1, ((bitcast<u32>(a) ^ bitcast<u32>(b)) >> 31u) == 1u);
}

// Sign of a·b − c·d, exactly.
fn sign_exactly(a: f32, b: f32, c: f32, d: f32) -> i32 {
    let left = sign_of_product(a, b);
    let right = sign_of_product(c, d);
    if left != right { return select(-1, 1, left > right); }
    if left == 0 { return 0; }
    let p = product(a, b);
    let q = product(c, d);
    if p.exponent != q.exponent { return select(-left, left, p.exponent > q.exponent); }
    if p.upper != q.upper { return select(-left, left, p.upper > q.upper); }
    if p.lower != q.lower { return select(-left, left, p.lower > q.lower); }
    return 0;
}

// The same; nearly always f32 can tell, however its sums are contracted.
fn sign_of_difference(a: f32, b: f32, c: f32, d: f32) -> i32 {
    let p = a * b;
    let q = c * d;
    let difference = p - q;
    let size = abs(p) + abs(q);
    if size > TELLING && abs(difference) > DOUBT * size { return select(-1, 1, difference > 0.0); }
    return sign_exactly(a, b, c, d);
}

// a / b rounded to nearest, ties to even; results below the normal numbers are 0. b must not be 0.
fn divide(a: f32, b: f32) -> f32 {
    let sign = (bitcast<u32>(a) ^ bitcast<u32>(b)) & 0x80000000u;
    if is_zero(a) { return bitcast<f32>(sign); }
    let x = magnitude(a);
    let y = magnitude(b);
    var exponent = x.exponent - y.exponent + 127;
    var rest = x.mantissa;
    if rest < y.mantissa {
        rest = rest << 1u;
        exponent -= 1;
    }
    var quotient = 0u;
    for (var i = 0u; i < 25u; i++) {
        quotient = quotient << 1u;
        if rest >= y.mantissa {
            rest -= y.mantissa;
            quotient |= 1u;
        }
        rest = rest << 1u;
    }
    var mantissa = quotient >> 1u;
    if (quotient & 1u) == 1u && (rest != 0u || (mantissa & 1u) == 1u) { mantissa += 1u; }
    if mantissa == 0x1000000u {
        mantissa = 0x800000u;
        exponent += 1;
    }
    if exponent <= 0 { return bitcast<f32>(sign); }
    if exponent >= 255 { return bitcast<f32>(sign | 0x7f7fffffu); }
    return bitcast<f32>(sign | (u32(exponent) << 23u) | (mantissa & 0x7fffffu));
}

// A sum of two floats, the first of which is their rounded sum: 48 bits of mantissa (Dekker 1971; Knuth's two-sum).
struct Double { high: f32, low: f32 }

fn two_sum(a: f32, b: f32) -> Double {
    let sum = keep(a + b);
    let part = keep(sum - a);
    return Double(sum, keep(keep(a - keep(sum - part)) + keep(b - part)));
}

fn upper_half(a: f32) -> f32 {
    let c = keep(4097.0 * a);
    return keep(c - keep(c - a));
}

fn two_product(a: f32, b: f32) -> Double {
    let p = keep(a * b);
    let ah = upper_half(a);
    let al = keep(a - ah);
    let bh = upper_half(b);
    let bl = keep(b - bh);
    let error = keep(keep(keep(keep(ah * bh) - p) + keep(ah * bl)) + keep(al * bh));
    return Double(p, keep(error + keep(al * bl)));
}

fn add(a: Double, b: Double) -> Double {
    let s = two_sum(a.high, b.high);
    let t = two_sum(a.low, b.low);
    let u = two_sum(s.high, keep(s.low + t.high));
    return two_sum(u.high, keep(u.low + t.low));
}

fn minus(a: Double) -> Double { return Double(-a.high, -a.low); }

fn times(a: Double, b: f32) -> Double {
    let p = two_product(a.high, b);
    return two_sum(p.high, keep(p.low + keep(a.low * b)));
}

// a / b rounded to f32; right but for the last bit or so of a double.
fn quotient(a: Double, b: Double) -> f32 {
    let q = keep(a.high / b.high);
    let rest = add(a, minus(times(b, q)));
    return keep(q + keep(rest.high / b.high));
}
