//! Every lane type against plain scalars.

use super::*;
use proptest::prelude::*;

/// A check that runs on lanes.
macro_rules! check {
    ($name:ident, |$lanes:ident, $data:ident: $type:ty| $body:block) => {
        struct $name<'a, S>(&'a $type, core::marker::PhantomData<S>);

        impl<S: Real> Vectorized for $name<'_, S> {
            type Scalar = S;
            type Output = ();

            #[inline(always)]
            fn run<$lanes: Lanes<Scalar = S>>(self) {
                let $data = self.0;
                $body
            }
        }

        impl<'a> $name<'a, ()> {
            /// Runs the check on every lane type.
            fn everywhere(data: &'a $type) {
                $name::<f32>(data, core::marker::PhantomData).run::<f32>();
                f32::dispatch($name(data, core::marker::PhantomData));
                f32::dispatch_portable($name(data, core::marker::PhantomData));
                $name::<f64>(data, core::marker::PhantomData).run::<f64>();
                f64::dispatch($name(data, core::marker::PhantomData));
                f64::dispatch_portable($name(data, core::marker::PhantomData));
                // Where the CPU has wider registers, these are not what it dispatches to.
                #[cfg(target_arch = "x86_64")]
                if let Some(cpu) = avx2::Avx2::detect() {
                    cpu.run_f32($name(data, core::marker::PhantomData));
                    cpu.run_f64($name(data, core::marker::PhantomData));
                }
            }
        }
    };
}

fn real<S: Real>(x: f64) -> S {
    S::from_f64(x)
}

/// The first lanes of eight numbers, as scalars and as lanes.
fn both<L: Lanes>(x: &[f64; 8]) -> ([L::Scalar; 8], L) {
    let scalars = x.map(real::<L::Scalar>);
    (scalars, L::load(&scalars))
}

/// Lane by lane equal, where not-a-number equals itself.
fn assert_lanes<L: Lanes>(computed: L, expected: impl Fn(usize) -> L::Scalar, what: &str) {
    let mut lanes = [real::<L::Scalar>(0.0); 8];
    computed.store(&mut lanes);
    for (l, lane) in lanes.into_iter().take(L::LANES).enumerate() {
        let (lane, expected) = (lane.to_f64(), expected(l).to_f64());
        assert!(
            lane == expected || lane.is_nan() && expected.is_nan(),
            "{what} lane {l} of {}: {lane}, not {expected}",
            core::any::type_name::<L>()
        );
    }
}

check!(Arithmetic, |L, data: [[f64; 8]; 3]| {
    let [(a, x), (b, y), (c, z)] = data.each_ref().map(both::<L>);
    assert_lanes(x + y, |l| a[l] + b[l], "sum");
    assert_lanes(x - y, |l| a[l] - b[l], "difference");
    assert_lanes(x * y, |l| a[l] * b[l], "product");
    assert_lanes(-x, |l| -a[l], "negative");
    assert_lanes(Lanes::div(x, y), |l| a[l] / b[l], "quotient");
    assert_lanes((x * x).sqrt(), |l| Lanes::sqrt(a[l] * a[l]), "root");
    assert_lanes(x.max(y), |l| a[l].max(b[l]), "larger");
    assert_lanes(x.min(y), |l| a[l].min(b[l]), "smaller");
    let select = |l| if a[l] < b[l] { c[l] } else { a[l] };
    assert_lanes(L::select_lt(x, y, z, x), select, "selected");
    assert_lanes(L::splat(a[3]), |_| a[3], "splat");
    assert_lanes(L::zero(), |_| real(0.0), "zero");
    let mut accumulated = x;
    accumulated += y;
    assert_lanes(accumulated, |l| a[l] + b[l], "accumulated");
});

proptest! {
    #[test]
    fn arithmetic_is_that_of_scalars(
        data in prop::array::uniform3(prop::array::uniform8(-1e3..1e3f64)),
    ) {
        Arithmetic::everywhere(&data);
    }
}

#[test]
fn what_is_not_a_number_follows_the_rules() {
    let nan = f64::NAN;
    let a = [nan, 1.0, nan, 0.0, -1.0, 2.0, nan, 5.0];
    let b = [1.0, nan, nan, 0.0, nan, 2.0, -7.0, 4.0];
    Arithmetic::everywhere(&[a, b, [9.0; 8]]);
    assert!(Lanes::max(nan, 1.0) == 1.0 && Lanes::max(1.0, nan).is_nan());
    assert!(Lanes::min(nan, 1.0) == 1.0 && Lanes::min(1.0, nan).is_nan());
}

check!(FusedMultiplyAdd, |L, data: [[f64; 8]; 3]| {
    let [(a, x), (b, y), (c, z)] = data.each_ref().map(both::<L>);
    let mut lanes = [real::<L::Scalar>(0.0); 8];
    x.mul_add(y, z).store(&mut lanes);
    let epsilon = if size_of::<S>() == 4 { f64::from(f32::EPSILON) } else { f64::EPSILON };
    for l in 0..L::LANES {
        let (product, c) = (a[l].to_f64() * b[l].to_f64(), c[l].to_f64());
        let allowed = 2.0 * epsilon * (product.abs() + c.abs());
        assert!((lanes[l].to_f64() - (product + c)).abs() <= allowed);
    }
});

proptest! {
    #[test]
    fn multiply_add_is_right_to_rounding(
        data in prop::array::uniform3(prop::array::uniform8(-1e3..1e3f64)),
    ) {
        FusedMultiplyAdd::everywhere(&data);
    }
}

check!(SumTree, |L, data: [f64; 8]| {
    let (a, x) = both::<L>(data);
    let expected = match L::LANES {
        8 => ((a[0] + a[4]) + (a[2] + a[6])) + ((a[1] + a[5]) + (a[3] + a[7])),
        4 => (a[0] + a[2]) + (a[1] + a[3]),
        _ => a[0],
    };
    assert_eq!(x.sum(), expected, "{}", core::any::type_name::<L>());
});

proptest! {
    #[test]
    fn sums_take_the_documented_order(data in prop::array::uniform8(-1e3..1e3f64)) {
        SumTree::everywhere(&data);
    }
}

check!(Gather, |L, data: (usize, [u32; 8])| {
    let (records, index) = data;
    let word = |i: usize, k: usize| real::<L::Scalar>((8 * i + k) as f64);
    let table: Vec<[L::Scalar; 8]> =
        (0..*records).map(|i| core::array::from_fn(|k| word(i, k))).collect();
    for (k, lanes) in L::gather(&table, index).into_iter().enumerate() {
        assert_lanes(lanes, |l| word(index[l] as usize, k), "gathered");
    }
});

proptest! {
    #[test]
    fn gather_transposes_records(
        case in (1..200usize).prop_flat_map(|n| (Just(n), prop::array::uniform8(0..n as u32))),
    ) {
        Gather::everywhere(&case);
    }
}

/// Whether each lane type refuses a gather.
fn gather_panics(records: usize, index: &[u32]) -> [bool; 6] {
    struct Plain<'a, S>(&'a [[S; 8]], &'a [u32]);
    impl<S: Real> Vectorized for Plain<'_, S> {
        type Scalar = S;
        type Output = f64;
        #[inline(always)]
        fn run<L: Lanes<Scalar = S>>(self) -> f64 {
            L::gather(self.0, self.1)[0].sum().to_f64()
        }
    }
    let (single, double) = (vec![[1.0f32; 8]; records], vec![[1.0f64; 8]; records]);
    let panics = |gather: &dyn Fn() -> f64| {
        std::panic::catch_unwind(std::panic::AssertUnwindSafe(gather)).is_err()
    };
    [
        panics(&|| Plain(&single, index).run::<f32>()),
        panics(&|| f32::dispatch(Plain(&single, index))),
        panics(&|| f32::dispatch_portable(Plain(&single, index))),
        panics(&|| Plain(&double, index).run::<f64>()),
        panics(&|| f64::dispatch(Plain(&double, index))),
        panics(&|| f64::dispatch_portable(Plain(&double, index))),
    ]
}

/// Number of lanes that double precision has on this CPU.
fn lanes_of_double() -> usize {
    struct Count;
    impl Vectorized for Count {
        type Scalar = f64;
        type Output = usize;
        #[inline(always)]
        fn run<L: Lanes<Scalar = f64>>(self) -> usize {
            L::LANES
        }
    }
    f64::dispatch(Count)
}

#[test]
fn gather_refuses_indices_out_of_range() {
    assert_eq!(gather_panics(3, &[2; 8]), [false; 6]);
    assert_eq!(gather_panics(3, &[3; 8]), [true; 6]);
    assert_eq!(gather_panics(3, &[u32::MAX; 8]), [true; 6]);
    assert_eq!(gather_panics(3, &[1 << 31; 8]), [true; 6]);
    assert_eq!(gather_panics(0, &[0; 8]), [true; 6]);
    for lane in 0..8 {
        let mut index = [1; 8];
        index[lane] = 3;
        // Lanes beyond the last one are not read.
        let (one, four, double) = (lane < 1, lane < 4, lane < lanes_of_double());
        assert_eq!(gather_panics(3, &index), [one, true, true, one, double, four], "lane {lane}");
    }
}

#[test]
fn gather_refuses_too_few_indices() {
    let wide = lanes_of_double() > 7;
    assert_eq!(gather_panics(3, &[0; 7]), [false, true, true, false, wide, false]);
    assert_eq!(gather_panics(3, &[0; 3]), [false, true, true, false, true, true]);
    assert_eq!(gather_panics(3, &[]), [true; 6]);
}

check!(CoordinateDifference, |L, data: ([f64; 8], [f64; 8])| {
    let unit = 1.0 / 1024.0;
    let encode = |x: &[f64; 8]| x.map(|x| L::Scalar::encode_coordinate(x, unit));
    let (a, b) = (encode(&data.0), encode(&data.1));
    let difference = L::coordinate_difference(L::load(&a), L::load(&b));
    let expected = |l: usize| {
        if size_of::<S>() == 4 {
            real((data.0[l] / unit).round() - (data.1[l] / unit).round())
        } else {
            a[l] - b[l]
        }
    };
    assert_lanes(difference, expected, "coordinate difference");
});

proptest! {
    // Far away the fixed-point coordinates have wrapped many times.
    #[test]
    fn coordinates_are_subtracted_in_units(
        far in -1e9..1e9f64,
        a in prop::array::uniform8(-1e3..1e3f64),
        b in prop::array::uniform8(-1e3..1e3f64),
    ) {
        let far = far.round();
        CoordinateDifference::everywhere(&(a.map(|x| x + far), b.map(|x| x + far)));
    }
}

#[test]
fn the_level_has_a_name() {
    assert!(["avx512", "avx2+fma", "portable"].contains(&simd_level()));
}
