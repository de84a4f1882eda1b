use proptest::prelude::*;

use super::*;
use crate::Column;

fn any_point() -> impl Strategy<Value = Point> {
    (
        prop::array::uniform3(-120.0..120.0),
        any::<(u8, u8, u8, u8)>(),
        any::<(i64, i64)>(),
        (-180.0..180.0, 0.0..1.0),
    )
        .prop_map(
            |(position_m, (intensity, ring, laser, echo), (host, device), (tilt, sd_m))| Point {
                position_m,
                intensity,
                ring,
                laser,
                time: Stamp::from_nanos(host),
                device_time: Stamp::from_nanos(device),
                tilt: Degrees(tilt),
                sd_m,
                echo,
            },
        )
}

fn any_fields() -> impl Strategy<Value = Fields> {
    prop::sample::subsequence(Column::ALL.to_vec(), 0..=Column::ALL.len()).prop_map(|columns| {
        columns
            .into_iter()
            .fold(Fields::NONE, |set, column| set | column.field())
    })
}

fn lengths(points: &Points) -> Vec<(Fields, usize)> {
    vec![
        (Fields::NONE, points.y_m().len()),
        (Fields::NONE, points.z_m().len()),
        (Fields::INTENSITY, points.intensity().len()),
        (Fields::RING, points.ring().len()),
        (Fields::LASER, points.laser().len()),
        (Fields::TIME, points.time().len()),
        (Fields::DEVICE_TIME, points.device_time().len()),
        (Fields::TILT, points.tilt_deg().len()),
        (Fields::SD, points.sd_m().len()),
        (Fields::ECHO, points.echo().len()),
    ]
}

/// The point as restored from columns `fields`.
fn kept(point: Point, fields: Fields) -> Point {
    let none = Point::default();
    Point {
        position_m: point.position_m,
        intensity: if fields.contains(Fields::INTENSITY) {
            point.intensity
        } else {
            none.intensity
        },
        ring: if fields.contains(Fields::RING) {
            point.ring
        } else {
            none.ring
        },
        laser: if fields.contains(Fields::LASER) {
            point.laser
        } else {
            none.laser
        },
        time: if fields.contains(Fields::TIME) {
            point.time
        } else {
            none.time
        },
        device_time: if fields.contains(Fields::DEVICE_TIME) {
            point.device_time
        } else {
            none.device_time
        },
        tilt: if fields.contains(Fields::TILT) {
            point.tilt
        } else {
            none.tilt
        },
        sd_m: if fields.contains(Fields::SD) {
            point.sd_m
        } else {
            none.sd_m
        },
        echo: if fields.contains(Fields::ECHO) {
            point.echo
        } else {
            none.echo
        },
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(128))]

    #[test]
    fn requested_columns_are_kept_and_others_stay_empty(
        fields in any_fields(),
        given in prop::collection::vec(any_point(), 0..40),
    ) {
        let mut points = Points::with_capacity(fields, given.len());
        for &point in &given {
            points.push(point);
        }
        prop_assert_eq!(points.len(), given.len());
        for (column, length) in lengths(&points) {
            let expected = if fields.contains(column) { given.len() } else { 0 };
            prop_assert_eq!(length, expected, "{:?}", column);
        }
        let expected: Vec<_> = given.iter().map(|&point| kept(point, fields)).collect();
        prop_assert_eq!(points.iter().collect::<Vec<_>>(), expected);
    }

    #[test]
    fn appending_batches_equals_pushing_their_points(
        fields in any_fields(),
        wider in any_fields(),
        given in prop::collection::vec(any_point(), 0..40),
        cut in 0usize..40,
    ) {
        let mut whole = Points::new(fields);
        let mut batch = Points::new(fields | wider);
        let mut pushed = Points::new(fields);
        for (index, &point) in given.iter().enumerate() {
            if index == cut {
                whole.append(&batch).unwrap();
                batch.clear();
                prop_assert!(batch.is_empty());
            }
            batch.push(point);
            pushed.push(point);
        }
        whole.append(&batch).unwrap();
        prop_assert_eq!(whole, pushed);
    }
}

#[test]
fn a_batch_with_a_missing_column_is_refused_entirely() {
    let mut whole = Points::new(Fields::TIME);
    let mut batch = Points::new(Fields::RING);
    batch.push(Point::default());
    let error = whole.append(&batch).unwrap_err();
    assert_eq!((error.missing, error.got), (Fields::TIME, Fields::RING));
    assert!(whole.is_empty());
}

#[test]
fn columns_not_requested_use_no_memory() {
    let points = Points::with_capacity(Fields::NONE, 1000);
    assert_eq!(points.time.capacity(), 0);
    assert_eq!(points.tilt_deg.capacity(), 0);
    assert_eq!(points.sd_m.capacity(), 0);
    assert_eq!(points.echo.capacity(), 0);
    assert!(points.x_m.capacity() >= 1000);
}

#[test]
fn clearing_keeps_the_memory() {
    let mut points = Points::with_capacity(Fields::TILT, 100);
    for _ in 0..100 {
        points.push(Point::default());
    }
    let before = points.tilt_deg.as_ptr();
    points.clear();
    assert_eq!(points.len(), 0);
    assert!(points.tilt_deg().is_empty());
    points.push(Point::default());
    assert_eq!(points.tilt_deg.as_ptr(), before);
}
