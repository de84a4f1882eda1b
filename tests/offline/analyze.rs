//! `velomotion analyze`.

use super::*;

/// Returns `density` of one input from `analyze --json`.
fn density(place: &Place, line: &str) -> serde_json::Value {
    let output = place.run(line);
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let report = json(&output);
    assert_eq!(report["patterns"].as_array().unwrap().len(), 1, "{report}");
    report["patterns"][0]["density"].clone()
}

#[test]
fn analyze_output_matches_the_documented_contract() {
    let place = Place::new();
    let output = place.run("analyze vlp16 rmbl:1200,step=2 --json");
    let report = json(&output);
    let patterns = report["patterns"].as_array().unwrap();
    assert_eq!(patterns.len(), 2);
    let (vlp16, rmbl) = (&patterns[0], &patterns[1]);
    assert_eq!(
        (
            vlp16["name"].as_str(),
            vlp16["points"].as_u64(),
            vlp16["frames"].as_u64()
        ),
        (Some("vlp16"), Some(14_416), Some(1))
    );
    assert_eq!(
        (rmbl["points"].as_u64(), rmbl["frames"].as_u64()),
        (Some(3 * 16 * 181), Some(3))
    );
    let density = &vlp16["density"];
    assert_eq!(density["bins"], 5_120);
    assert_eq!(density["mean"].as_f64(), Some(14_416.0 / 5_120.0));
    for key in [
        "sd",
        "min",
        "max",
        "mean_per_deg2",
        "sd_per_deg2",
        "histogram",
    ] {
        assert!(!density[key].is_null(), "{key}: {density}");
    }
    assert!(
        (vlp16["hole"]["radius_deg"].as_f64().unwrap() - 75.0).abs() < 1e-4,
        "{vlp16}"
    );
    assert!(
        vlp16["device"].is_null() && rmbl["device"]["range_m"].is_array(),
        "{report}"
    );
    assert_k_matches_contract(&vlp16["k"]);
    let text = place.run("analyze vlp16 rmbl:1200,step=2,d=0.06");
    let text = String::from_utf8_lossy(&text.stdout).into_owned();
    assert!(
        text.contains("14416") && text.contains("largest hole: 75.00 deg"),
        "{text}"
    );
    assert!(
        text.lines().all(|line| line.chars().count() <= 80),
        "{text}"
    );
}

/// Checks K of a level VLP-16, whose largest and smallest D are known.
fn assert_k_matches_contract(k: &serde_json::Value) {
    let number = |key: &str| k[key].as_f64().unwrap();
    assert_eq!(
        (k["method"].as_str(), k["bins"].as_u64()),
        (Some("exact"), Some(151))
    );
    assert_eq!((number("radius_m"), number("error_bound")), (1.0, 0.0));
    let list = |key: &str| -> Vec<f64> {
        let list = k[key].as_array().unwrap();
        list.iter().map(|x| x.as_f64().unwrap()).collect()
    };
    let (difference, d) = (list("k_minus_csr"), list("d"));
    assert_eq!((difference.len(), d.len()), (151, 151));
    let area = 4.0 * std::f64::consts::PI;
    for (difference, d) in difference.iter().zip(&d) {
        assert!((difference - area * d).abs() < 1e-14, "{difference} {d}");
    }
    assert!((number("d_max") - 0.094_86).abs() < 1e-5 && (number("d_min") + 0.094_93).abs() < 1e-5);
    assert!((number("max_abs") - area * 0.094_93).abs() < area * 1e-5);
}

/// A grid of 0.4 deg has pairs on the edges of 150 bins and none on those of 151. Only the first
/// gets a warning, in JSON and on stderr.
#[test]
fn pairs_on_bin_edges_give_a_warning() {
    let place = Place::new();
    for (bins, pairs) in [(150, 63_175), (180, 216_600), (151, 0)] {
        let output = place.run(&format!("analyze vlp16 --level 2 --bins {bins} --json"));
        let report = json(&output);
        let pattern = &report["patterns"][0];
        assert_eq!(pattern["k"]["on_edges"], pairs, "{bins} bins");
        let warnings = pattern["warnings"].as_array().unwrap();
        let printed = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(warnings.len(), usize::from(pairs > 0), "{warnings:?}");
        if let Some(warning) = warnings.first() {
            let warning = warning.as_str().unwrap();
            assert!(warning.contains(&format!("{pairs} pairs")) && warning.contains("--bins 151"));
            assert!(printed.contains(warning), "{printed}");
        } else {
            assert!(!printed.contains("warning"), "{printed}");
        }
    }
}

#[test]
fn a_pattern_its_clouds_and_its_log_give_the_same_analysis() {
    let place = Place::new();
    let pattern = sim::patterns::PatternRequest::parse("velomotion16:500,step=0.8")
        .unwrap()
        .build()
        .unwrap();
    let rows = pattern
        .directions()
        .into_iter()
        .map(|d| format!("{},{},{}\n", 7.0 * d.x, 7.0 * d.y, 7.0 * d.z));
    let text: String = std::iter::once("x_m,y_m,z_m\n".to_owned())
        .chain(rows)
        .collect();
    std::fs::write(place.path("cloud.csv"), text).unwrap();
    let [named, cloud] = ["velomotion16:500,step=0.8", "cloud.csv"]
        .map(|input| density(&place, &format!("analyze {input} --json")));
    assert_eq!(named["mean"], cloud["mean"]);
    // Rounding may move pairs that lie between two bins.
    assert!(
        (named["sd"].as_f64().unwrap() - cloud["sd"].as_f64().unwrap()).abs() < 0.01,
        "{named} {cloud}"
    );
    // The simulator's sphere: two revolutions of a level VLP-16, as a log.
    let scene = "[sensor]\nideal = true\nrpm = 1200\n[motion]\nkind = \"fixed\"\nduration_s = 0.1\n[[objects]]\nsphere = { radius_m = 10 }\n";
    std::fs::write(place.path("level.toml"), scene).unwrap();
    assert!(
        place
            .run("simulate level.toml -o level.pcapng")
            .status
            .success()
    );
    let log = place.run("analyze level.pcapng --json");
    let log = json(&log)["patterns"][0].clone();
    let level = density(&place, "analyze vlp16,frames=2 --json");
    assert_eq!(log["frames"], 2, "{log}");
    let [found, expected] = [&log["density"], &level].map(|d| d["mean"].as_f64().unwrap());
    assert!((found / expected - 1.0).abs() < 0.02, "{found} {expected}");
    assert!(
        (log["hole"]["radius_deg"].as_f64().unwrap() - 75.0).abs() < 0.1,
        "{log}"
    );
}

/// The rim that an off-axis sensor cannot see is outside the view.
#[test]
fn field_of_view_figures_follow_the_position_of_the_sensor() {
    let place = Place::new();
    let line = "analyze vlp16 vlp16,d=0.5 vlp16,d=5 velomotion16:50 velomotion16:50,d=0.06 velomotion16:50,d=-0.06 --level 4 --k-error 0.1 --json";
    let report = json(&place.run(line));
    let patterns = report["patterns"].as_array().unwrap();
    let found: Vec<[f64; 2]> = patterns
        .iter()
        .map(|pattern| {
            let hole = pattern["hole_in_view"]["radius_deg"].as_f64().unwrap();
            [hole, pattern["gaps"]["of_99_percent_deg"].as_f64().unwrap()]
        })
        .collect();
    // A level sensor's circles lie at most 2 deg apart, however high it is. Near the sphere the
    // upper ones are farther apart, and lower ones closer.
    assert!((found[0][0] - 1.02).abs() < 0.01, "{found:?}");
    assert!(found[1][0] < 1.08 && found[1][1] < 1.08, "{found:?}");
    assert!(found[2][0] < 1.6 && found[2][1] < 1.6, "{found:?}");
    assert!((found[3][0] - 2.485).abs() < 0.001, "{found:?}");
    for lifted in &found[4..] {
        assert!((lifted[0] - found[3][0]).abs() < 0.05, "{found:?}");
        assert!((lifted[1] - found[3][1]).abs() < 0.1, "{found:?}");
    }
}

/// The view of a log follows from its lidar, sweep and mount and equals that of its pattern. A
/// cloud has no view, and none is assumed.
#[test]
fn logs_have_a_field_of_view_and_clouds_have_none() {
    let place = Place::new();
    let scene = "[sensor]\nideal = true\nrpm = 600\n[mount]\nd_m = 0.06\n[motion]\nkind = \"sweeps\"\nfrom_deg = 0\nto_deg = -45\nspeed_deg_s = 50\n[[objects]]\nsphere = { radius_m = 10 }\n";
    std::fs::write(place.path("swept.toml"), scene).unwrap();
    let made = place.run("simulate swept.toml -o swept.pcapng");
    assert!(
        made.status.success(),
        "{}",
        String::from_utf8_lossy(&made.stderr)
    );
    let made = place.run("replay swept.pcapng -o swept.ply");
    assert!(
        made.status.success(),
        "{}",
        String::from_utf8_lossy(&made.stderr)
    );
    let line = "analyze velomotion16:50,rpm=600,d=0.06 swept.pcapng swept.ply --k-error 0.1";
    let report = json(&place.run(&format!("{line} --json")));
    let [pattern, log, cloud] = report["patterns"].as_array().unwrap().as_slice() else {
        panic!("{report}");
    };
    let number = |of: &serde_json::Value, path: &str| of.pointer(path).unwrap().as_f64().unwrap();
    for (path, within) in [
        // A log begins at any azimuth and has ramps. The invisible rim would be a hole of 55 deg.
        ("/hole_in_view/radius_deg", 1.5),
        ("/gaps/of_99_percent_deg", 0.4),
        ("/gaps/median_deg", 0.05),
        ("/density_in_view/bins", 10.0),
        ("/density_in_view/coverage", 0.01),
        ("/view/tilt_deg/0", 0.01),
        ("/view/distance_m/0", 0.02),
        ("/view/d_m", 1e-9),
    ] {
        let [a, b] = [pattern, log].map(|of| number(of, path));
        assert!((a - b).abs() <= within, "{path}: {a} {b}");
    }
    assert_eq!(
        (&log["gaps"]["of"], &cloud["gaps"]["of"]),
        (&"view".into(), &"all".into())
    );
    for unknown in ["view", "hole_in_view", "density_in_view"] {
        assert!(cloud.get(unknown).unwrap().is_null(), "{unknown}");
        assert!(log[unknown].is_object(), "{unknown}");
    }
    for unknown in ["holes", "rows", "least_radius_deg"] {
        assert!(cloud["blind"].get(unknown).unwrap().is_null(), "{unknown}");
        assert!(!log["blind"][unknown].is_null(), "{unknown}");
    }
    // One definition per heading.
    for of in [pattern, log] {
        for density in ["density", "density_in_view"] {
            let [sd, mean, both] =
                ["sd", "mean", "sd_over_mean"].map(|key| number(&of[density], &format!("/{key}")));
            assert!((sd / mean - both).abs() < 1e-12, "{density}");
        }
    }
    let text = place.run(line);
    let text = String::from_utf8_lossy(&text.stdout).into_owned();
    let row = text.lines().find(|line| line.ends_with(" -"));
    assert!(
        row.is_some() && text.contains("largest hole in view: not known"),
        "{text}"
    );
    assert!(
        text.contains("of all directions (the whole sphere)"),
        "{text}"
    );
    assert!(
        text.lines().all(|line| line.chars().count() <= 80),
        "{text}"
    );
}

/// The evenness of a setting is the same number in every output.
#[test]
fn sweep_and_report_agree_on_a_pattern() {
    let place = Place::new();
    let sweep = json(&place.run("analyze velomotion16:400 --sweep speed=400..400 --json"));
    let alone = json(&place.run("analyze velomotion16:400 --k-error 0.1 --json"));
    let [setting, pattern] = [&sweep["settings"][0], &alone["patterns"][0]];
    let pairs = [
        (
            &setting["sd_over_mean_in_view"],
            &pattern["density_in_view"]["sd_over_mean"],
        ),
        (&setting["gap_deg"], &pattern["gaps"]["of_99_percent_deg"]),
        (&setting["hole_deg"], &pattern["hole_in_view"]["radius_deg"]),
    ];
    for (a, b) in pairs {
        let [a, b] = [a, b].map(|x| x.as_f64().unwrap());
        assert!((a - b).abs() < 0.006, "{a} {b}");
    }
    assert_ne!(
        pattern["density_in_view"]["sd_over_mean"],
        pattern["density"]["sd_over_mean"]
    );
}

/// An origin far from the cloud, as with national coordinates, gets a warning with a remedy.
#[test]
fn a_cloud_far_from_its_origin_gives_a_warning_and_can_be_moved() {
    let place = Place::new();
    let pattern = sim::patterns::PatternRequest::parse("velomotion16:500,step=0.8").unwrap();
    let pattern = pattern.build().unwrap();
    let text = |x: f64, y: f64| -> String {
        let rows = pattern.directions().into_iter();
        rows.map(|d| format!("{} {} {}\n", x + 7.0 * d.x, y + 7.0 * d.y, 7.0 * d.z))
            .collect()
    };
    std::fs::write(place.path("here.csv"), text(0.0, 0.0)).unwrap();
    std::fs::write(place.path("far.xyz"), text(450_000.0, 5_400_000.0)).unwrap();
    let far = place.run("analyze far.xyz --k-error 0.1 --json");
    let printed = String::from_utf8_lossy(&far.stderr).into_owned();
    let far = json(&far)["patterns"][0].clone();
    let warned = far["warnings"][0].as_str().unwrap();
    assert!(
        warned.contains("outside the cloud") && warned.contains("--origin X,Y,Z"),
        "{warned}"
    );
    assert!(printed.contains(warned), "{printed}");
    let moved = json(&place.run("analyze far.xyz --origin 450000,5400000,0 --k-error 0.1 --json"));
    let here = json(&place.run("analyze here.csv --k-error 0.1 --json"));
    let [moved, here] = [&moved["patterns"][0], &here["patterns"][0]];
    assert_eq!(moved["warnings"].as_array().unwrap().len(), 0, "{moved}");
    let radius = |of: &serde_json::Value| of["hole"]["radius_deg"].as_f64().unwrap();
    assert!((radius(moved) - radius(here)).abs() < 1e-4 && radius(&far) > 179.0);
    // `--origin`, too, takes negative numbers.
    let back = place.run("analyze here.csv --origin -1,0.5,-0.25 --level 2 --k-error 0.1");
    assert!(
        back.status.success(),
        "{}",
        String::from_utf8_lossy(&back.stderr)
    );
}

/// `-q` keeps the result.
#[test]
fn results_are_printed_even_when_quiet() {
    let place = Place::new();
    for line in [
        "analyze vlp16 --level 2 --k-error 0.1",
        "analyze velomotion16,step=2 --level 2 --sweep speed=200..400/2",
    ] {
        let (loud, quiet) = (place.run(line), place.run(&format!("{line} -q")));
        assert!(!quiet.stdout.is_empty() && quiet.stderr.is_empty());
        assert_eq!(loud.stdout, quiet.stdout, "{line}");
    }
}

/// Rows without coordinates are left out and counted in every format.
#[test]
fn non_finite_points_are_skipped_and_reported() {
    let place = Place::new();
    let rows = "1 2 3\nnan nan nan\n3 2 -1\n";
    let ply = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
    let pcd = "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 3\nHEIGHT 1\nPOINTS 3\nDATA ascii\n";
    for (name, head) in [
        ("a.ply", ply),
        ("a.pcd", pcd),
        ("a.txt", ""),
        ("a.asc", "x y z\n"),
    ] {
        std::fs::write(place.path(name), format!("{head}{rows}")).unwrap();
        let line = format!("analyze {name} --level 1 --bins 10");
        let report = json(&place.run(&format!("{line} --json")));
        let pattern = &report["patterns"][0];
        assert_eq!(pattern["points"], 2, "{name}");
        assert_eq!(pattern["without_numbers"], 1, "{name}");
        let text = place.run(&line);
        let text = String::from_utf8_lossy(&text.stdout).into_owned();
        assert!(
            text.contains("1 point whose coordinates are no numbers left out"),
            "{text}"
        );
    }
}

/// A report of two scans has page, figures, tables and JSON, and overwrites nothing.
#[test]
fn analyze_writes_a_self_contained_report() {
    let place = Place::new();
    let line =
        "analyze vlp16,step=2 rmbl:1200,step=2 --level 2 --bins 30 --report out/report --json";
    let output = place.run(line);
    let printed = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{printed}");
    let report = json(&output);
    let file = |name: &str| {
        assert!(printed.contains(name), "{name} in:\n{printed}");
        std::fs::read_to_string(place.path("out/report").join(name)).unwrap()
    };
    let written: serde_json::Value = serde_json::from_str(&file("analyze.json")).unwrap();
    assert_eq!(written, report);
    let page = file("index.html");
    for name in ["density.svg", "histogram.svg", "planes.svg", "k.svg"] {
        let figure = file(name);
        assert!(
            figure.starts_with("<svg") && page.contains(&figure),
            "{name}"
        );
    }
    // The tables hold the values of the JSON.
    let (k, density) = (file("k.csv"), file("density.csv"));
    // Names of patterns may have commas, so columns are counted from the end.
    let after_d = k.lines().next().unwrap().rsplit(',');
    let after_d = after_d.take_while(|name| *name != "d").count();
    let d = k.lines().skip(1).map(|line| {
        let fields = line.rsplit(',');
        fields.skip(after_d).take(1).collect::<String>()
    });
    let d: Vec<f64> = d.map(|d| d.parse().unwrap()).collect();
    let curves = report["patterns"].as_array().unwrap().iter();
    let curves: Vec<f64> = curves
        .flat_map(|pattern| pattern["k"]["d"].as_array().unwrap())
        .map(|d| d.as_f64().unwrap())
        .collect();
    assert_eq!((d.len(), curves.len()), (60, 60));
    // JSON reads back within the last digit.
    for (table, json) in d.iter().zip(&curves) {
        assert!((table - json).abs() < 1e-15, "{table} {json}");
    }
    let points = |name: &str| -> u64 {
        let lines = density.lines().filter(|line| line.starts_with(name));
        lines
            .map(|line| line.rsplit(',').next().unwrap().parse::<u64>().unwrap())
            .sum()
    };
    for (pattern, name) in report["patterns"]
        .as_array()
        .unwrap()
        .iter()
        .zip(["\"vlp16", "\"rmbl"])
    {
        assert_eq!(pattern["points"], points(name), "{name}");
    }
    assert_eq!(
        file("histogram.csv").lines().next(),
        Some("pattern,from,to,bins")
    );

    place.fails(
        line,
        2,
        &["out/report exists already and is not empty", "--force"],
    );
    let again = place.run(&format!("{line} --force"));
    assert!(again.status.success());
    assert_eq!(file("index.html"), page);
    place.fails(
        "analyze vlp16 --report velomotion.toml",
        2,
        &["velomotion.toml exists already"],
    );
    let both = place.run("analyze rmbl:50 --sweep rpm=300..600 --report page");
    assert_eq!(both.status.code(), Some(2));
    let printed = String::from_utf8_lossy(&both.stderr);
    assert!(printed.contains("cannot be used with"), "{printed}");
    let alone = place.run("analyze vlp16 --force");
    assert_eq!(alone.status.code(), Some(2));
}

#[test]
fn inputs_that_cannot_be_analysed_are_errors() {
    let place = Place::new();
    std::fs::write(place.path("one.csv"), "x,y,z\n1,2,3\n").unwrap();
    let one = json(&place.run("analyze one.csv --json"));
    let warned = one["patterns"][0]["warnings"].to_string();
    assert!(warned.contains("no pairs"), "{warned}");
    std::fs::write(place.path("none.csv"), "x,y,z\n").unwrap();
    std::fs::write(place.path("empty.csv"), "").unwrap();
    std::fs::write(place.path("origin.csv"), "X,Y,Z\n0,0,0\n").unwrap();
    let zero = "ply\nformat ascii 1.0\nelement vertex 0\nproperty double x\nproperty double y\nproperty double z\nend_header\n";
    std::fs::write(place.path("zero.ply"), zero).unwrap();
    std::fs::write(place.path("nan.csv"), "x,y,z\n4,nan,6\n").unwrap();
    std::fs::write(place.path("words.txt"), "no cloud at all\n").unwrap();
    std::fs::write(place.path("spoilt.ply"), "ply\nwhat\n").unwrap();
    for (line, code, words) in [
        ("analyze", 2, "PATTERN|CLOUD|LOG"),
        ("analyze rmbl", 2, "a speed above 0 deg/s"),
        ("analyze vlp16,to=-30", 2, "a speed with to, accel and spin"),
        ("analyze nosuch", 3, "there is no pattern and no file"),
        ("analyze none.csv", 3, "none.csv: the file has no points"),
        ("analyze empty.csv", 3, "empty.csv: the file has no points"),
        ("analyze zero.ply", 3, "zero.ply: the file has no points"),
        ("analyze origin.csv", 3, "no point that has a direction"),
        (
            "analyze nan.csv",
            3,
            "no point whose coordinates are numbers",
        ),
        (
            "analyze words.txt",
            3,
            "expected one row per point with x, y and z in metres",
        ),
        ("analyze one.csv --origin 1,2", 2, "expected three numbers"),
        (
            "analyze one.csv --origin 1,2,x",
            2,
            "expected three numbers",
        ),
        (
            "analyze one.csv --origin 1,2,3",
            3,
            "no point that has a direction",
        ),
        ("analyze vlp16 --origin 1,2,3", 2, "no cloud is named"),
        (
            "analyze nosuch.ply",
            3,
            ".e57 .mcap .csv .xyz .bin .npz .txt .asc",
        ),
        ("analyze vlp16,start=0,start=90", 2, "expected start once"),
        ("analyze velomotion16:50,,d=1", 2, "expected KEY=VALUE"),
        (
            "analyze velomotion16:50,from=0,to=0",
            2,
            "from and to that differ",
        ),
        (
            "analyze spoilt.ply",
            3,
            "ply: byte 4: expected a line of a PLY header",
        ),
        ("analyze velomotion.toml", 3, "velomotion.toml"),
        ("analyze vlp16 --k-error 1", 2, "expected a share from 0"),
        ("analyze vlp16 --bins 0", 2, "a whole number from 1 to 3600"),
        ("analyze vlp16 --level 9", 2, "a whole number from 0 to 8"),
        (
            "analyze vlp16 rmbl:50 --sweep rpm=300..600",
            2,
            "settings of one pattern, not of 2",
        ),
        (
            "analyze velomotion16 --sweep speed",
            2,
            "expected KEY=FROM..TO",
        ),
        (
            "analyze velomotion16 --sweep colour=1..2",
            2,
            "expected a number: rpm, step, start",
        ),
        (
            "analyze velomotion16 --sweep rpm=300..600",
            2,
            "a speed above 0 deg/s",
        ),
    ] {
        let output = place.run(line);
        let printed = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(code), "{line}:\n{printed}");
        let flat = printed.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(flat.contains(words), "{line}: no {words:?} in:\n{printed}");
    }
}

#[test]
fn a_sweep_marks_the_undominated_settings() {
    let place = Place::new();
    let output = place.run("analyze velomotion16,step=2 --sweep speed=100..400/3,tilt=1..2 --json");
    assert_eq!(output.status.code(), Some(2), "tilt is no number");
    let printed = String::from_utf8_lossy(&output.stderr).into_owned();
    let flat = printed.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(
        flat.contains("tilt is no number") && flat.contains("tilt=stepped"),
        "{printed}"
    );
    for (sweep, settings) in [("speed=200..200", 1), ("speed=200..400/2,rpm=600..600", 2)] {
        let report = json(&place.run(&format!(
            "analyze velomotion16,step=2 --sweep {sweep} --json"
        )));
        assert_eq!(
            report["settings"].as_array().unwrap().len(),
            settings,
            "{sweep}"
        );
    }
    let output =
        place.run("analyze velomotion16,step=2 --sweep speed=100..400/3,rpm=600..1200/2 --json");
    let report = json(&output);
    assert_eq!(report["keys"], serde_json::json!(["speed", "rpm"]));
    let settings = report["settings"].as_array().unwrap();
    assert_eq!(settings.len(), 6);
    let number = |setting: &serde_json::Value, key: &str| setting[key].as_f64().unwrap();
    for (best, of) in [
        ("best_hole", "hole_deg"),
        ("best_gap", "gap_deg"),
        ("best_evenness", "sd_over_mean_in_view"),
    ] {
        for setting in settings {
            let beaten = settings.iter().any(|other| {
                number(other, "scan_s") <= number(setting, "scan_s")
                    && number(other, of) < number(setting, of) - 0.01
            });
            assert!(!(beaten && setting[best] == true), "{best}: {setting}");
        }
        assert!(
            settings.iter().any(|setting| setting[best] == true),
            "{best}"
        );
    }
    let text = place.run("analyze velomotion16,step=2 --sweep speed=100..400/3,rpm=600..1200/2");
    let text = String::from_utf8_lossy(&text.stdout).into_owned();
    assert!(
        text.contains("in view   in view    in view")
            && text.contains("* no other setting")
            && text.lines().all(|line| line.chars().count() <= 80),
        "{text}"
    );
}

/// The signal arrives in the middle of 5e11 pairs.
#[test]
fn ctrl_c_ends_an_analysis_with_130_and_no_partial_report() {
    for signal in ["-INT", "-TERM"] {
        let place = Place::new();
        let mut analysis = Command::new(env!("CARGO_BIN_EXE_velomotion"))
            .args(
                "analyze rmbl:1200,step=2 velomotion16:5,step=0.1 --k-error 0 --report page"
                    .split(' '),
            )
            .current_dir(place.0.path())
            .stdout(std::process::Stdio::null())
            .stderr(std::process::Stdio::piped())
            .spawn()
            .unwrap();
        // Each of several inputs is named before its analysis begins.
        let mut printed = std::io::BufReader::new(analysis.stderr.take().unwrap());
        let mut line = String::new();
        while !line.contains("velomotion16:5") {
            line.clear();
            let read = std::io::BufRead::read_line(&mut printed, &mut line).unwrap();
            assert!(read > 0, "the command ended early");
        }
        let kill = Command::new("kill")
            .args([signal, &analysis.id().to_string()])
            .status();
        assert!(kill.unwrap().success());
        let mut rest = String::new();
        std::io::Read::read_to_string(&mut printed, &mut rest).unwrap();
        assert_eq!(analysis.wait().unwrap().code(), Some(130), "{rest}");
        assert!(rest.contains("stopped by the user"), "{rest}");
        let written = std::fs::read_dir(place.path("page")).unwrap().count();
        assert_eq!(written, 0, "a partial report was written");
    }
}
