//! The few operations on complex numbers that the residual needs.

use core::ops::{Add, Mul, Sub};
use num_traits::Float;

/// `re + j im`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Complex {
    pub re: f64,
    pub im: f64,
}

impl Complex {
    pub const ONE: Self = Self { re: 1.0, im: 0.0 };

    #[inline]
    pub fn new(re: f64, im: f64) -> Self {
        Self { re, im }
    }

    /// `mu = -xi + j sqrt(1 - xi^2)`: the pole of a mode over its natural frequency.
    #[inline]
    pub fn unit_pole(damping_ratio: f64) -> Self {
        Self::new(
            -damping_ratio,
            Float::sqrt(1.0 - damping_ratio * damping_ratio),
        )
    }

    #[inline]
    pub fn exp(self) -> Self {
        let (sin, cos) = Float::sin_cos(self.im);
        let radius = Float::exp(self.re);
        Self::new(radius * cos, radius * sin)
    }

    #[inline]
    pub fn abs(self) -> f64 {
        Float::hypot(self.re, self.im)
    }

    #[inline]
    pub fn norm_squared(self) -> f64 {
        self.re * self.re + self.im * self.im
    }

    #[inline]
    pub fn scale(self, factor: f64) -> Self {
        Self::new(self.re * factor, self.im * factor)
    }

    /// `1 / self`.
    #[inline]
    pub fn inverse(self) -> Self {
        Self::new(self.re, -self.im).scale(1.0 / self.norm_squared())
    }

    /// Real part of `conj(self) other`.
    #[inline]
    pub fn dot(self, other: Self) -> f64 {
        self.re * other.re + self.im * other.im
    }
}

impl Add for Complex {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        Self::new(self.re + other.re, self.im + other.im)
    }
}

impl Sub for Complex {
    type Output = Self;
    #[inline]
    fn sub(self, other: Self) -> Self {
        Self::new(self.re - other.re, self.im - other.im)
    }
}

impl Mul for Complex {
    type Output = Self;
    #[inline]
    fn mul(self, other: Self) -> Self {
        Self::new(
            self.re * other.re - self.im * other.im,
            self.re * other.im + self.im * other.re,
        )
    }
}
