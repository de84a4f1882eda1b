//! Thumbnail of a cloud: its points from above and one side, coloured by height, with edges shaded
//! by depth, on a transparent ground.
//!
//! The view is the page's initial one.

use std::sync::{Arc, Mutex, PoisonError};

use cloud::{Points, Sink, SinkError};

/// Width in pixels.
pub const WIDTH: usize = 324;
/// Height in pixels.
pub const HEIGHT: usize = 216;

/// Samples per pixel along either side.
const FINE: usize = 2;
/// Largest number of points drawn; of more, every second, fourth and so on.
const MOST_POINTS: usize = 300_000;
/// Direction of the eye from the scanner: from x towards y, and above the horizon, radians.
const AZIMUTH: f64 = -2.05;
const ELEVATION: f64 = 0.62;
/// Tangent of half the vertical field of view.
const HALF_TAN: f64 = 0.466_307_658;
/// Distance of the eye relative to the points' own.
const AWAY: f64 = 1.6;
/// Strength of the shading.
const SHADE: f64 = 9.0;
/// viridis of matplotlib (CC0), 17 samples.
const VIRIDIS: [[u8; 3]; 17] = [
    [68, 1, 84],
    [72, 24, 106],
    [71, 45, 123],
    [66, 64, 134],
    [59, 82, 139],
    [51, 99, 141],
    [44, 114, 142],
    [38, 130, 142],
    [33, 145, 140],
    [31, 160, 136],
    [40, 174, 128],
    [63, 188, 115],
    [94, 201, 98],
    [132, 212, 75],
    [173, 220, 48],
    [216, 226, 25],
    [253, 231, 37],
];

type Point = [f64; 3];

/// A sink that keeps an even sample of a cloud's positions. Clones share it.
#[derive(Clone, Default)]
pub struct Thumbnail(Arc<Mutex<SampledPoints>>);

#[derive(Default)]
struct SampledPoints {
    points: Vec<Point>,
    /// Points of the cloud so far.
    count: usize,
    /// One of 2 to this power of the points is kept.
    halvings: u32,
}

impl Sink for Thumbnail {
    fn points(&mut self, batch: &Points) -> Result<(), SinkError> {
        let mut sample = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        for position in batch.positions() {
            let is_kept = sample.count.trailing_zeros() >= sample.halvings;
            sample.count += 1;
            if !is_kept || !position.iter().all(|value| value.is_finite()) {
                continue;
            }
            sample.points.push(position);
            if sample.points.len() >= MOST_POINTS {
                let mut is_even = false;
                sample.points.retain(|_| {
                    is_even = !is_even;
                    is_even
                });
                sample.halvings += 1;
            }
        }
        Ok(())
    }
}

impl Thumbnail {
    /// The picture of the points so far, as PNG with a transparent ground.
    ///
    /// # Errors
    /// Where the picture cannot be encoded.
    pub fn png(&self) -> Result<Vec<u8>, png::EncodingError> {
        let sample = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        encode(&picture(&sample.points))
    }
}

/// The value below which a share of the values lies.
fn quantile(values: impl Iterator<Item = f64>, share: f64) -> f64 {
    let mut values: Vec<f64> = values.collect();
    // The list is short enough that its length is exact as f64.
    let place = (share * values.len().saturating_sub(1) as f64) as usize;
    if place >= values.len() {
        return 0.0;
    }
    *values.select_nth_unstable_by(place, f64::total_cmp).1
}

/// Height of a ceiling, metres: many points of nearly one height above all others.
fn ceiling_m(points: &[Point]) -> f64 {
    let begin = quantile(points.iter().map(|p| p[2]), 0.97) - 0.5;
    let above = points.iter().filter(|p| p[2] > begin).count();
    if begin > 0.5 && 10 * above > points.len() {
        begin
    } else {
        f64::INFINITY
    }
}

fn dot(a: Point, b: Point) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn unit(a: Point) -> Point {
    let length = dot(a, a).sqrt().max(f64::MIN_POSITIVE);
    a.map(|value| value / length)
}

/// A sample of a pixel: distance in metres and colour.
#[derive(Clone, Copy)]
struct Sample {
    depth_m: f64,
    colour: [f64; 3],
}

const NOTHING: Sample = Sample {
    depth_m: f64::INFINITY,
    colour: [0.0; 3],
};

/// The samples of a picture, in rows from the top.
struct Picture {
    samples: Vec<Sample>,
}

const ACROSS: usize = WIDTH * FINE;
const DOWN: usize = HEIGHT * FINE;

fn picture(points: &[Point]) -> Picture {
    let reach_m = quantile(points.iter().map(|&p| dot(p, p).sqrt()), 0.97);
    let low = quantile(points.iter().map(|p| p[2]), 0.01);
    let high = quantile(points.iter().map(|p| p[2]), 0.99).max(low + 1e-3);
    let ceiling_m = ceiling_m(points);
    let (sin_a, cos_a) = AZIMUTH.sin_cos();
    let (sin_e, cos_e) = ELEVATION.sin_cos();
    let back = [cos_e * cos_a, cos_e * sin_a, sin_e];
    let right = [-sin_a, cos_a, 0.0];
    let up = [-sin_e * cos_a, -sin_e * sin_a, cos_e];
    let away_m = AWAY * reach_m.max(0.1);
    let eye = back.map(|value| value * away_m);
    let scale = DOWN as f64 / (2.0 * HALF_TAN);
    let mut picture = Picture {
        samples: vec![NOTHING; ACROSS * DOWN],
    };
    for &point in points {
        let to_eye = [eye[0] - point[0], eye[1] - point[1], eye[2] - point[2]];
        // The scanner saw the front of every surface: one that shows its back would hide others.
        let facing = -dot(unit(point), unit(to_eye));
        let depth_m = away_m - dot(point, back);
        let hides = (point[2] > -0.5 && facing < -0.1) || point[2] > ceiling_m;
        if hides || depth_m < 0.05 * away_m {
            continue;
        }
        let x = ACROSS as f64 / 2.0 + scale * dot(point, right) / depth_m;
        let y = DOWN as f64 / 2.0 - scale * dot(point, up) / depth_m;
        // The colour map's dark end would vanish on a dark page.
        let colour = viridis(0.12 + 0.88 * (point[2] - low) / (high - low));
        picture.dot(x, y, Sample { depth_m, colour });
    }
    picture
}

/// The colour of a share from 0 to 1.
fn viridis(share: f64) -> [f64; 3] {
    let at = share.clamp(0.0, 1.0) * (VIRIDIS.len() - 1) as f64;
    // Not negative and below 17.
    let below = at as usize;
    let sample = |place: usize| VIRIDIS.get(place).or(VIRIDIS.last()).copied();
    let (from, to) = (
        sample(below).unwrap_or_default(),
        sample(below + 1).unwrap_or_default(),
    );
    let part = at.fract();
    std::array::from_fn(|c| {
        let colour = |of: [u8; 3]| f64::from(of.get(c).copied().unwrap_or_default());
        colour(from) + (colour(to) - colour(from)) * part
    })
}

impl Picture {
    fn at(&self, x: i64, y: i64) -> Option<&Sample> {
        let (x, y) = (usize::try_from(x).ok()?, usize::try_from(y).ok()?);
        self.samples.get((x < ACROSS).then(|| y * ACROSS + x)?)
    }

    /// Draws a dot of three by three samples where nothing nearer is.
    fn dot(&mut self, x: f64, y: f64, sample: Sample) {
        let (x, y) = (x.floor() as i64, y.floor() as i64);
        for row in y.saturating_sub(1)..=y.saturating_add(1) {
            for column in x.saturating_sub(1)..=x.saturating_add(1) {
                let (Ok(column), Ok(row)) = (usize::try_from(column), usize::try_from(row)) else {
                    continue;
                };
                if column >= ACROSS {
                    continue;
                }
                if let Some(there) = self.samples.get_mut(row * ACROSS + column)
                    && sample.depth_m < there.depth_m
                {
                    *there = sample;
                }
            }
        }
    }

    /// Brightness of a sample: darker the farther it lies behind its neighbours (eye-dome lighting,
    /// Boucheny 2009).
    fn light(&self, x: i64, y: i64, here: &Sample) -> f64 {
        const AROUND: [(i64, i64); 8] = [
            (-2, 0),
            (2, 0),
            (0, -2),
            (0, 2),
            (-1, -1),
            (1, 1),
            (-1, 1),
            (1, -1),
        ];
        let behind: f64 = AROUND
            .iter()
            .filter_map(|(dx, dy)| self.at(x + dx, y + dy))
            .filter(|there| there.depth_m.is_finite())
            .map(|there| (here.depth_m / there.depth_m).log2().max(0.0))
            .sum();
        (-SHADE * behind / 8.0).exp()
    }

    /// Red, green, blue and opacity of a pixel.
    fn pixel(&self, x: usize, y: usize) -> [u8; 4] {
        let (mut sum, mut seen) = ([0.0; 3], 0.0);
        for sub in 0..FINE * FINE {
            let at = |place: usize, sub: usize| i64::try_from(place * FINE + sub).ok();
            let (Some(x), Some(y)) = (at(x, sub % FINE), at(y, sub / FINE)) else {
                continue;
            };
            if let Some(sample) = self.at(x, y)
                && sample.depth_m.is_finite()
            {
                let light = self.light(x, y, sample);
                for (sum, colour) in sum.iter_mut().zip(sample.colour) {
                    *sum += colour * light;
                }
                seen += 1.0;
            }
        }
        let [r, g, b] = sum.map(|value| if seen > 0.0 { value / seen } else { 0.0 } as u8);
        [r, g, b, (255.0 * seen / (FINE * FINE) as f64) as u8]
    }
}

fn encode(picture: &Picture) -> Result<Vec<u8>, png::EncodingError> {
    let pixels: Vec<u8> = (0..WIDTH * HEIGHT)
        .flat_map(|place| picture.pixel(place % WIDTH, place / WIDTH))
        .collect();
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, WIDTH as u32, HEIGHT as u32);
    encoder.set_color(png::ColorType::Rgba);
    encoder.write_header()?.write_image_data(&pixels)?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;

    use cloud::Fields;

    use super::*;

    fn thumbnail(points: &[Point]) -> Thumbnail {
        let mut batch = Points::new(Fields::NONE);
        for &position_m in points {
            batch.push(cloud::Point {
                position_m,
                ..cloud::Point::default()
            });
        }
        let mut thumbnail = Thumbnail::default();
        thumbnail.points(&batch).unwrap();
        thumbnail
    }

    /// A floor of 10 m by 10 m, 1 m below the scanner, and a wall 4 m high behind it, from the
    /// viewpoint.
    fn corner() -> Vec<Point> {
        let line = || (-100..=100).map(|i| f64::from(i) * 0.05);
        let floor = line().flat_map(|x| line().map(move |y| [x, y, -1.0]));
        let wall = line().flat_map(|x| (0..80).map(move |z| [x, 5.0, f64::from(z) * 0.05 - 1.0]));
        floor.chain(wall).collect()
    }

    fn decoded(png: &[u8]) -> Vec<[u8; 4]> {
        let mut reader = png::Decoder::new(Cursor::new(png)).read_info().unwrap();
        let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut bytes).unwrap();
        assert_eq!((info.width as usize, info.height as usize), (WIDTH, HEIGHT));
        bytes.as_chunks::<4>().0.to_vec()
    }

    fn picture_of(points: &[Point]) -> Vec<[u8; 4]> {
        decoded(&thumbnail(points).png().unwrap())
    }

    #[test]
    fn high_points_are_bright_and_empty_pixels_are_transparent() {
        let pixels = picture_of(&corner());
        let seen = pixels.iter().filter(|pixel| pixel[3] > 0).count();
        assert!(
            (pixels.len() / 5..pixels.len()).contains(&seen),
            "{seen} of {}",
            pixels.len()
        );
        assert_eq!(pixels[0][3], 0);
        // The floor has the dark end of the colour map, below; the wall's top the bright end,
        // above.
        let rows_of = |wanted: fn(&[u8; 4]) -> bool| {
            let rows: Vec<usize> = (0..pixels.len())
                .filter(|&place| pixels[place][3] == 255 && wanted(&pixels[place]))
                .map(|place| place / WIDTH)
                .collect();
            assert!(rows.len() > 100, "{}", rows.len());
            rows.iter().sum::<usize>() / rows.len()
        };
        let (top, floor) = (
            rows_of(|p| p[0] > 140 && p[1] > 180),
            rows_of(|p| p[0] > p[1] && p[2] > p[0]),
        );
        assert!(top + 40 < floor, "{top} {floor}");
    }

    #[test]
    fn ceiling_and_near_wall_do_not_hide_the_interior() {
        let line = || (-100..=100).map(|i| f64::from(i) * 0.05);
        let ceiling = line().flat_map(|x| line().map(move |y| [x, y, 4.0]));
        let near = line().flat_map(|x| (30..80).map(move |z| [x, -5.0, f64::from(z) * 0.05 - 1.0]));
        let room: Vec<Point> = corner().into_iter().chain(ceiling).chain(near).collect();
        let dark = |pixels: Vec<[u8; 4]>| {
            let floor = |p: &&[u8; 4]| p[3] == 255 && p[0] > p[1] && p[2] > p[0];
            pixels.iter().filter(floor).count()
        };
        let open = dark(picture_of(&corner()));
        let closed = dark(picture_of(&room));
        assert!(open > 10_000 && closed > open / 2, "{open} {closed}");
    }

    #[test]
    fn an_empty_cloud_gives_an_empty_picture() {
        let pixels = picture_of(&[]);
        assert!(pixels.iter().all(|&pixel| pixel == [0; 4]));
    }

    #[test]
    fn an_even_sample_of_many_points_is_drawn() {
        let many: Vec<Point> = (0..700_000).map(|i| [f64::from(i), 0.0, 0.0]).collect();
        let thumbnail = thumbnail(&many);
        let points = &thumbnail.0.lock().unwrap().points;
        assert_eq!(points.len(), 175_000);
        assert_eq!((points[1][0], points[174_999][0]), (4.0, 4.0 * 174_999.0));
    }
}
