//! Every property of every kernel, from one list.

use super::*;
use crate::Vectorized;
use core::f64::consts::PI;
use core::marker::PhantomData;
use proptest::prelude::*;

macro_rules! for_every_kernel {
    ($check:ident) => {
        $check::<WendlandC2>();
        $check::<WendlandC4>();
        $check::<WendlandC6>();
        $check::<CubicSpline>();
        $check::<QuinticSpline>();
        $check::<Gaussian>();
    };
}

/// Weights of the composite Gauss rule with five points on `n` intervals of [0, 1].
fn integrate(f: impl Fn(f64) -> f64, n: usize) -> f64 {
    let (a, b) = (0.538_469_310_105_683, 0.906_179_845_938_664);
    let (u, v, w) = (0.568_888_888_888_888_9, 0.478_628_670_499_366_5, 0.236_926_885_056_189_1);
    let half = 0.5 / n as f64;
    let interval = |i: usize| {
        let middle = (2 * i + 1) as f64 * half;
        let at = |x: f64| f(middle + half * x);
        half * (u * at(0.0) + v * (at(a) + at(-a)) + w * (at(b) + at(-b)))
    };
    (0..n).map(interval).sum()
}

fn integral_is_one<K: Kernel>() {
    for (d, surface) in [(1, 2.0), (2, 2.0 * PI), (3, 4.0 * PI)] {
        // Six intervals end at the knots of both splines.
        let radial = integrate(|q| K::w(q) * q.powi(d - 1), 24);
        let integral = K::norm(d as usize) * surface * radial;
        assert!((integral - 1.0).abs() < 1e-12, "{} in {d}-D: {integral}", K::NAME);
    }
}

#[test]
fn every_kernel_integrates_to_one() {
    for_every_kernel!(integral_is_one);
}

fn slope_is_derivative<K: Kernel>() {
    let step = 1e-5;
    for i in 1..1000 {
        let q = f64::from(i) / 1000.0 - 3e-4;
        let numeric = (K::w(q + step) - K::w(q - step)) / (2.0 * step);
        let exact = K::slope(q) * q;
        let scale = K::w(0.0);
        assert!((numeric - exact).abs() < 2e-8 * scale, "{} at {q}: {exact} {numeric}", K::NAME);
    }
    // At the centre the slope is the second derivative.
    let curvature = 2.0 * (K::w(step) - K::w(0.0)) / (step * step);
    assert!((K::slope(0.0) / curvature - 1.0).abs() < 1e-3, "{} at 0: {curvature}", K::NAME);
}

#[test]
fn slope_is_the_derivative_over_q() {
    for_every_kernel!(slope_is_derivative);
}

fn support_is_compact<K: Kernel>() {
    for q in [1.0, 1.0 + 1e-9, 1.5, 2.0, 3.0, 1e6] {
        assert_eq!((K::w(q), K::slope(q)), (0.0, 0.0), "{} at {q}", K::NAME);
        let q = q as f32;
        assert_eq!((K::w(q), K::slope(q)), (0.0, 0.0), "{} at {q}", K::NAME);
    }
    for i in 0..1000 {
        let q = f64::from(i) / 1000.0;
        assert!(K::w(q) > 0.0 && K::slope(q) < 0.0, "{} at {q}", K::NAME);
        assert!(K::w(q) > K::w(q + 1e-3), "{} rises at {q}", K::NAME);
    }
}

#[test]
fn support_ends_at_one() {
    for_every_kernel!(support_is_compact);
}

/// Evaluates a kernel at every entry, lanes at a time.
struct Evaluate<'a, K, S>(&'a [S], PhantomData<K>);

impl<K: Kernel, S: Real> Vectorized for Evaluate<'_, K, S> {
    type Scalar = S;
    type Output = Vec<(S, S)>;

    #[inline(always)]
    fn run<L: Lanes<Scalar = S>>(self) -> Vec<(S, S)> {
        let mut all = Vec::new();
        for q in self.0.chunks_exact(L::LANES).map(L::load) {
            let [mut w, mut slope] = [[S::from_f64(0.0); 8]; 2];
            K::w(q).store(&mut w);
            K::slope(q).store(&mut slope);
            all.extend(w.into_iter().zip(slope).take(L::LANES));
        }
        all
    }
}

/// Lanes against scalars: equal but for the roundings that fused multiply-add saves (the Gaussian raises
/// them to the 16th power), relative to
/// the largest value.
fn lanes_equal_scalars<K: Kernel, S: Real>(epsilon: f64) {
    let q: Vec<S> = (0..1600).map(|i| S::from_f64(f64::from(i) / 1440.0)).collect();
    let scalar = Evaluate::<K, S>(&q, PhantomData).run::<S>();
    let portable = S::dispatch_portable(Evaluate::<K, S>(&q, PhantomData));
    let widest = S::dispatch(Evaluate::<K, S>(&q, PhantomData));
    assert_eq!((scalar.len(), widest.len()), (q.len(), q.len()));
    let scale = (scalar[0].0.to_f64(), scalar[0].1.to_f64().abs());
    for (k, &(w, slope)) in scalar.iter().enumerate() {
        for (other_w, other_slope) in [portable[k], widest[k]] {
            let error_w = (w - other_w).to_f64().abs() / scale.0;
            let error_slope = (slope - other_slope).to_f64().abs() / scale.1;
            assert!(error_w.max(error_slope) < 32.0 * epsilon, "{} at {}", K::NAME, q[k]);
        }
    }
    if cfg!(all(target_arch = "x86_64", not(target_feature = "fma"))) {
        assert_eq!(scalar, portable, "{}: the same operations must give the same bits", K::NAME);
    }
}

fn lanes_equal_scalars_of_both_types<K: Kernel>() {
    lanes_equal_scalars::<K, f32>(f32::EPSILON.into());
    lanes_equal_scalars::<K, f64>(f64::EPSILON);
}

#[test]
fn lanes_give_what_scalars_give() {
    for_every_kernel!(lanes_equal_scalars_of_both_types);
}

fn single_precision_is_close<K: Kernel>() {
    for i in 0..1100 {
        let q = i as f32 / 1000.0;
        let exact = f64::from(q);
        let w = (f64::from(K::w(q)) - K::w(exact)).abs() / K::w(0.0);
        let slope = (f64::from(K::slope(q)) - K::slope(exact)).abs() / K::slope(0.0f64).abs();
        assert!(w.max(slope) < 3e-6, "{} at {q}: {w} {slope}", K::NAME);
    }
}

#[test]
fn single_precision_follows_double() {
    for_every_kernel!(single_precision_is_close);
}

#[test]
fn gaussian_follows_the_exponential() {
    for i in 0..1000 {
        let q = f64::from(i) / 1000.0;
        let ratio = Gaussian::w(q) / (-9.0 * q * q).exp();
        assert!((ratio - 1.0).abs() < 1e-14, "at {q}: {ratio}");
    }
}

#[test]
#[should_panic(expected = "1, 2 or 3 dimensions, not 4")]
fn four_dimensions_are_refused() {
    WendlandC2::norm(4);
}

proptest! {
    #[test]
    fn gradient_is_antisymmetric_and_points_down(
        x in prop::array::uniform3(-1.0..1.0f64), radius in 0.1..3.0f64,
    ) {
        let forward = WendlandC4::gradient(x, radius);
        let backward = WendlandC4::gradient(x.map(|x| -x), radius);
        prop_assert_eq!(forward, backward.map(|g| -g));
        for (g, x) in forward.into_iter().zip(x) {
            prop_assert!(g * x <= 0.0);
        }
    }

    #[test]
    fn gradient_is_the_derivative_of_the_value(
        x in prop::array::uniform2(-1.0..1.0f64), radius in 0.5..3.0f64,
    ) {
        let step = 1e-6;
        let value = |x: [f64; 2]| QuinticSpline::value::<2, f64>(x[0].hypot(x[1]), radius);
        let gradient = QuinticSpline::gradient(x, radius);
        let scale = QuinticSpline::value::<2, f64>(0.0, radius) / radius;
        let numeric = [
            value([x[0] + step, x[1]]) - value([x[0] - step, x[1]]),
            value([x[0], x[1] + step]) - value([x[0], x[1] - step]),
        ];
        for (exact, difference) in gradient.into_iter().zip(numeric) {
            prop_assert!((exact - difference / (2.0 * step)).abs() < 1e-7 * scale);
        }
    }
}
