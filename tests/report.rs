//! One report with every element: complete in itself, escaped, thinned. It is written to the
//! target directory, to be looked at: `target/tmp/report.html`.

use quell::page::{Bars, Cell, Chain, Chart, Figure, Page, Table, Verdict};

/// A name as an attacker would give it to a recording.
const HOSTILE: &str = "</script><img src=x onerror=alert(1)>&\"'";

fn decay(times: &[f64], amplitude: f64, end: f64) -> Vec<f64> {
    let (damping_ratio, natural_frequency) = (0.084, 8.12 * std::f64::consts::TAU);
    let at = |&time: &f64| {
        let phase = natural_frequency * (time - end);
        let envelope = if time < end {
            1.0
        } else {
            (-damping_ratio * phase).exp()
        };
        amplitude * envelope * phase.sin() * (time / 0.1).min(1.0)
    };
    times.iter().map(at).collect()
}

fn deformation() -> Chart {
    let times: Vec<_> = (0..1200).map(|k| f64::from(k) / 1000.0).collect();
    Chart::lines("Deformation at the tip", "time", "s", "deformation", "mm")
        .series("unshaped", &times, &decay(&times, 0.74, 0.39))
        .series("shaped, wrong belief", &times, &decay(&times, 0.31, 0.45))
        .series("adaptive, first move", &times, &decay(&times, 0.04, 0.46))
        .series("adaptive, next move", &times, &decay(&times, 0.004, 0.45))
        .marker(0.39, "unshaped command ends")
        .marker(0.45, "shaped commands end")
        .level(0.05, "settled: 0.05 mm")
        .note("The two adaptive moves lie on the zero line once the command has ended.")
}

fn estimate() -> Chart {
    let times: Vec<_> = (0..60).map(|k| 0.1 + 0.005 * f64::from(k)).collect();
    let mean: Vec<_> = times
        .iter()
        .map(|t| 8.12 + 2.0 * (-(t - 0.1) / 0.04).exp())
        .collect();
    let half: Vec<_> = times
        .iter()
        .map(|t| 0.05 + 3.0 * (-(t - 0.1) / 0.05).exp())
        .collect();
    let low: Vec<_> = mean.iter().zip(&half).map(|(m, h)| m - h).collect();
    let high: Vec<_> = mean.iter().zip(&half).map(|(m, h)| m + h).collect();
    Chart::lines("Frequency, as it is learnt", "time", "s", "frequency", "Hz")
        .band("likelihood", "± 2 standard deviations", &times, &low, &high)
        .series("likelihood", &times, &mean)
        .points(
            "algebraic",
            &[0.2, 0.25, 0.3, 0.35],
            &[9.1, 8.4, f64::NAN, 8.15],
        )
        .level(8.12, "truth: 8.12 Hz")
        .marker(0.21, "converged")
        .y_range(5.0, 13.0)
}

fn sensitivity() -> Chart {
    let ratios: Vec<_> = (0..400).map(|k| 0.5 + 0.0025 * f64::from(k)).collect();
    let zv: Vec<_> = ratios
        .iter()
        .map(|r| 160.0 * (r - 1.0_f64).abs() + 1e-9)
        .collect();
    let zvd: Vec<_> = ratios
        .iter()
        .map(|r| 250.0 * (r - 1.0_f64).powi(2) + 1e-9)
        .collect();
    Chart::lines(
        "Residual vibration over the true frequency",
        "f / f design",
        "",
        "residual",
        "%",
    )
    .series("ZV", &ratios, &zv)
    .series("ZVD", &ratios, &zvd)
    .level(5.0, "5 %")
    .y_log()
    .y_range(1e-3, 200.0)
}

fn long_noise() -> Chart {
    let times: Vec<_> = (0..50_000).map(|k| f64::from(k) / 4000.0).collect();
    let noise = |k: usize| ((k * 7919 % 1009) as f64 / 1009.0 - 0.5) * 20.0;
    let mut values: Vec<_> = (0..times.len()).map(noise).collect();
    values[31_415] = 43.2198;
    Chart::lines("Noise of the tracker", "time", "s", "error", "um")
        .series(HOSTILE, &times, &values)
}

fn page() -> Page {
    let row = |name: &str, residual, percent, delay: Option<f64>| {
        [
            Cell::from(name),
            Cell::Number(residual),
            Cell::Number(percent),
            delay.into(),
        ]
    };
    let trains = Chart::stems(
        "Impulse trains for 8.12 Hz and 8.4 %",
        "time",
        "s",
        "amplitude",
        "",
    )
    .series("ZV", &[0.0, 0.0618], &[0.56582, 0.43418])
    .series("ZVD", &[0.0, 0.0618, 0.1236], &[0.32016, 0.49133, 0.18851]);
    let negative = Chart::stems("UM-ZV", "time", "s", "amplitude", "").series(
        "UM-ZV",
        &[0.0, 0.02362, 0.04126],
        &[1.0, -1.0, 1.0],
    );
    let (f, a): (Vec<_>, Vec<_>) = (1..200)
        .map(|k| {
            let f = 0.5 * f64::from(k);
            (
                f,
                1.0 / ((1.0 - (f / 8.12_f64).powi(2)).powi(2) + (0.168 * f / 8.12).powi(2)).sqrt(),
            )
        })
        .unzip();
    Page::new("Joint 1 moves by 30 degrees")
        .subtitle("Embedded arm, 8.12 Hz and 8.4 %; belief 25 % too low; noise 10 µm; seed 1")
        .verdict(
            Verdict::Good,
            "The adapted shaper leaves 0.6 % of the vibration on the next move, and 5 % within \
             the first; the target is met to 1e-12 rad.",
        )
        .figure(Figure::new("residual vibration", 0.0044, "mm").note("0.74 mm unshaped"))
        .figure(Figure::new("of the unshaped vibration", 0.6, "%").note("goal: at most 2 %"))
        .figure(
            Figure::text("frequency", "8.12 ± 0.03")
                .unit("Hz")
                .note("truth 8.12 Hz"),
        )
        .figure(Figure::new("time to converge", 74.0, "ms").note("0.6 periods"))
        .table(
            Table::new("The same move, four ways")
                .text_column("move")
                .column("peak residual", "mm")
                .column("of unshaped", "%")
                .column("added delay", "ms")
                .row(row("unshaped", 0.74, 100.0, None))
                .row(row("shaped, wrong belief", 0.31, 41.9, Some(77.0)))
                .row(row("adaptive, first move", 0.037, 5.0, Some(72.0)))
                .row(row("adaptive, next move", 0.0044, 0.595, Some(61.8)))
                .marked()
                .note("Peak after the command's end, at the tool tip."),
        )
        .chart(deformation())
        .heading("What was learnt, and when")
        .text("The estimator sees the motion phase, so that it converges before the command ends.")
        .chart(estimate())
        .heading("Shapers")
        .chart(trains)
        .chart(negative)
        .chart(sensitivity())
        .bars(
            Bars::new(
                "Band in which at most 5 % are left",
                "%",
                ["ZV", "ZVD", "EI"],
            )
            .series("width", &[7.3, 33.06, 45.88])
            .level(20.0, "spread of this arm"),
        )
        .bars(
            Bars::new("Residual by estimator", "mm", ["first move", "next move"])
                .series("likelihood", &[0.037, 0.0044])
                .series("algebraic", &[0.09, 0.012])
                .note("Smaller is better."),
        )
        .heading("Sensors")
        .chain(
            Chain::new("Where the noise comes from")
                .station("motor", "moves")
                .station(HOSTILE, "measures")
                .marked("here")
                .beside("floor", "shakes"),
        )
        .chart(long_noise())
        .chart(
            Chart::lines("Predicted", "time", "s", "position", "mm")
                .broad("recorded", &f, &a)
                .series("predicted", &f, &a)
                .shade_x(20.0, 30.0, "not fitted to")
                .shade_y(-0.5, 0.5, "noise")
                .shade_x(f64::NAN, 3.0, "nowhere"),
        )
        .bars(
            Bars::new("What is left", "%", ["this", "that"])
                .series("left", &[3.0, 4000.0])
                .marked(0)
                .up_to(100.0),
        )
        .chart(
            Chart::lines("Spectrum", "frequency", "Hz", "gain", "")
                .series("gain", &f, &a)
                .marker(8.12, "8.12 Hz")
                .x_log()
                .y_log(),
        )
        .footnote(format!("From {HOSTILE}"))
        .footnote("quell move --belief 6.09,0.084 --seed 1")
}

#[test]
fn a_page_is_complete_and_asks_for_nothing() {
    let html = page().render();
    for outward in [
        "src=\"",
        "href=",
        "url(",
        "@import",
        "fetch(",
        "XMLHttpRequest",
    ] {
        assert!(!html.contains(outward), "{outward}");
    }
    assert!(html.contains("default-src 'none'"));
    page()
        .write(concat!(env!("CARGO_TARGET_TMPDIR"), "/report.html"))
        .unwrap();
}

#[test]
fn what_users_name_is_escaped() {
    let html = page().render();
    assert!(!html.contains("<img") && !html.contains("\"</script>"));
    assert!(html.contains("&lt;/script&gt;&lt;img src=x onerror=alert(1)&gt;&amp;&quot;'"));
    // One closing tag for each of the four scripts: none comes from data.
    assert_eq!(html.matches("</script>").count(), 4);
}

#[test]
fn a_long_series_is_thinned_and_says_so() {
    let html = page().render();
    assert!(html.contains("of 50000 samples are drawn"));
    assert!(html.contains(",43.2198,"), "the one spike is still there");
    assert!(html.len() < 1_000_000, "{} bytes", html.len());
}

#[test]
fn what_is_marked_and_shaded_is_on_the_page() {
    let html = page().render();
    assert_eq!(html.matches("<li class=\"mark\">").count(), 1);
    assert_eq!(html.matches("<li class=\"beside\">").count(), 1);
    assert!(html.contains("{\"from\":20,\"to\":30,\"label\":\"not fitted to\",\"upright\":false}"));
    assert!(
        !html.contains("nowhere\",\"upright"),
        "a stretch without an end is left out"
    );
    // 3 of 100 %, on a track that leaves a quarter for the number; the bar that is cut off fills it.
    assert!(html.contains("width:2.25%;background:var(--plain)"));
    assert!(html.contains("width:75.00%;background:var(--quiet)"));
}

#[test]
fn a_page_that_cannot_be_written_says_where() {
    let error = page()
        .write("/nowhere/report.html")
        .unwrap_err()
        .to_string();
    assert!(
        error.starts_with("cannot write the report /nowhere/report.html: "),
        "{error}"
    );
}
