//! A number, and where it came from: an expression over the raw JSON that anybody can compute again.

use crate::basics::median::median;
use serde_json::Value;
use std::ops::{Add, Div, Mul, Sub};

/// A value and its expression. A leaf is a JSON pointer (RFC 6901), alone or in `median(…)`, or a constant; the
/// operators are `+ − × ÷`, always in brackets.
#[derive(Clone, Debug, PartialEq)]
pub struct Number {
    /// NaN where the JSON has no such number.
    pub value: f64,
    /// How it is computed.
    pub from: String,
}

impl From<f64> for Number {
    fn from(value: f64) -> Self {
        Self { value, from: value.to_string() }
    }
}

impl Number {
    /// True where the JSON had all that it is computed from.
    pub fn is_known(&self) -> bool {
        self.value.is_finite()
    }

    /// How much smaller `self` is than `base`, per cent.
    pub fn saved_of(&self, base: &Self) -> Self {
        Self::from(100.0) - Self::from(100.0) * self.clone() / base.clone()
    }

    fn join(self, sign: char, other: Self, value: f64) -> Self {
        Self { value, from: format!("({} {sign} {})", self.from, other.from) }
    }
}

impl Add for Number {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let value = self.value + other.value;
        self.join('+', other, value)
    }
}

impl Sub for Number {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        let value = self.value - other.value;
        self.join('−', other, value)
    }
}

impl Mul for Number {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let value = self.value * other.value;
        self.join('×', other, value)
    }
}

impl Div for Number {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        self.join('÷', other, value)
    }
}

/// The raw JSON, to be read by pointers.
#[derive(Clone, Copy, Debug)]
pub struct Json<'a>(pub &'a Value);

impl<'a> Json<'a> {
    /// What is at `pointer`; null where nothing is.
    pub fn value(self, pointer: &str) -> &'a Value {
        self.0.pointer(pointer).unwrap_or(&Value::Null)
    }

    /// The elements at `pointer`.
    pub fn list(self, pointer: &str) -> &'a [Value] {
        self.value(pointer).as_array().map_or(&[], Vec::as_slice)
    }

    /// The text at `pointer`, or nothing.
    pub fn text(self, pointer: &str) -> &'a str {
        self.value(pointer).as_str().unwrap_or_default()
    }

    /// The number at `pointer`.
    pub fn number(self, pointer: &str) -> Number {
        Number { value: self.value(pointer).as_f64().unwrap_or(f64::NAN), from: pointer.to_owned() }
    }

    /// The median of the numbers at `pointer`.
    pub fn median(self, pointer: &str) -> Number {
        Number {
            value: median(&self.numbers(pointer)).unwrap_or(f64::NAN),
            from: format!("median({pointer})"),
        }
    }

    fn numbers(self, pointer: &str) -> Vec<f64> {
        self.list(pointer).iter().map(|value| value.as_f64().unwrap_or(f64::NAN)).collect()
    }

    /// Index of the first element at `pointer` whose `key` is `wanted`.
    pub fn find(self, pointer: &str, key: &str, wanted: &str) -> Option<usize> {
        self.list(pointer).iter().position(|value| value[key].as_str() == Some(wanted))
    }
}
