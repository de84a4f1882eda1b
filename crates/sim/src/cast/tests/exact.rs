//! The slow reference in arbitrary-precision fractions, without shears and trees: Cramer's rule on
//! `origin + t direction = a + u (b - a) + v (c - a)`.

use num_rational::BigRational;

use super::*;

type Exact = [BigRational; 3];

fn exact(of: DVec3) -> Exact {
    of.to_array().map(|c| BigRational::from_float(c).unwrap())
}

fn minus(a: &Exact, b: &Exact) -> Exact {
    [&a[0] - &b[0], &a[1] - &b[1], &a[2] - &b[2]]
}

fn cross(a: &Exact, b: &Exact) -> Exact {
    [
        &a[1] * &b[2] - &a[2] * &b[1],
        &a[2] * &b[0] - &a[0] * &b[2],
        &a[0] * &b[1] - &a[1] * &b[0],
    ]
}

fn dot(a: &Exact, b: &Exact) -> BigRational {
    &a[0] * &b[0] + &a[1] * &b[1] + &a[2] * &b[2]
}

fn rounded(of: &BigRational) -> f64 {
    // Enough digits for any f64, then an integer division.
    let shift = BigRational::from_float(2.0_f64.powi(80)).unwrap();
    let whole = (of * shift).to_integer();
    whole.to_string().parse::<f64>().unwrap() / 2.0_f64.powi(80)
}

/// Distance to a triangle ahead, edges and corners included; `None` for a miss and for a ray in its
/// plane.
pub(in crate::cast) fn triangle(ray: &Ray, corners: [DVec3; 3]) -> Option<BigRational> {
    let (origin, along) = (exact(ray.origin_m()), exact(ray.direction()));
    let [a, b, c] = corners.map(exact);
    let (ab, ac, from) = (minus(&b, &a), minus(&c, &a), minus(&origin, &a));
    let zero = BigRational::from_float(0.0).unwrap();
    let one = BigRational::from_float(1.0).unwrap();
    let across = cross(&along, &ac);
    let whole = dot(&ab, &across);
    if whole == zero {
        return None;
    }
    let u = dot(&from, &across) / &whole;
    let around = cross(&from, &ab);
    let v = dot(&along, &around) / &whole;
    let range = dot(&ac, &around) / &whole;
    (u >= zero && v >= zero && &u + &v <= one && range > zero).then_some(range)
}

/// Whether a ray passes near enough to a triangle to hit it; others skip the slow fractions.
fn is_near(ray: &Ray, [a, b, c]: &[DVec3; 3]) -> bool {
    let long = (b - a).length().max((c - a).length());
    let from = *a - ray.origin_m();
    from.cross(ray.direction()).length() <= 1.01 * long + 1e-3
}

/// The nearest of many triangles, in metres.
pub(in crate::cast) fn nearest(
    ray: &Ray,
    vertices: &[DVec3],
    triangles: &[[u32; 3]],
) -> Option<f64> {
    triangles
        .iter()
        .map(|corners| corners.map(|at| vertices[at as usize]))
        .filter(|corners| is_near(ray, corners))
        .filter_map(|corners| triangle(ray, corners))
        .min()
        .map(|range| rounded(&range))
}

/// Distance to a sphere about the origin, by the quadratic formula in fractions; the root by
/// bisection to 2^-100.
pub(in crate::cast) fn sphere(ray: &Ray, centre: DVec3, radius_m: f64) -> Option<f64> {
    let along = exact(ray.direction());
    let from = minus(&exact(ray.origin_m()), &exact(centre));
    let radius = BigRational::from_float(radius_m).unwrap();
    let zero = BigRational::from_float(0.0).unwrap();
    let (a, b) = (dot(&along, &along), dot(&from, &along));
    let c = dot(&from, &from) - &radius * &radius;
    let inside = &b * &b - &a * &c;
    if inside < zero {
        return None;
    }
    let two = BigRational::from_float(2.0).unwrap();
    let (mut low, mut high) = (
        zero.clone(),
        &inside + BigRational::from_float(1.0).unwrap(),
    );
    for _ in 0..160 {
        let middle = (&low + &high) / &two;
        if &middle * &middle <= inside {
            low = middle;
        } else {
            high = middle;
        }
    }
    let (near, far) = ((-&b - &low) / &a, (-&b + &low) / &a);
    [near, far].iter().find(|at| **at > zero).map(rounded)
}
