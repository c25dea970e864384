//! Pages as a person sees them: the curves are drawn, and no two names share a colour.

#[path = "absent/skipped.rs"]
mod skipped;

use skipped::skipped;
use std::collections::BTreeSet;
use std::path::Path;
use std::process::Command;
use tempfile::TempDir;

/// The page of a verb that is run in a folder.
fn page(folder: &Path, verb: &str, file: &str) -> String {
    let mut command = Command::new(env!("CARGO_BIN_EXE_quell"));
    command.args([verb, "--out", "out"]).current_dir(folder);
    assert!(command.output().unwrap().status.success());
    std::fs::read_to_string(folder.join("out").join(file)).unwrap()
}

/// The page once its scripts have run; none, with a word, where there is no Chromium.
fn drawn(folder: &Path, file: &str) -> Option<String> {
    let mut command = Command::new("chromium");
    command.args(["--headless", "--no-sandbox", "--disable-gpu", "--dump-dom"]);
    command.arg(format!(
        "--user-data-dir={}",
        folder.join("profile").display()
    ));
    command.arg(format!(
        "file://{}",
        folder.join("out").join(file).display()
    ));
    let Ok(output) = command.output() else {
        skipped("there is no chromium: the pages are not drawn");
        return None;
    };
    Some(String::from_utf8_lossy(&output.stdout).into_owned())
}

#[test]
fn every_chart_is_drawn() {
    let folder = TempDir::new().unwrap();
    for (verb, file) in [("compare", "compare.html"), ("move", "report.html")] {
        let charts = page(folder.path(), verb, file)
            .matches("id=\"plot-")
            .count();
        assert!(charts > 0, "{verb}");
        let Some(drawn) = drawn(folder.path(), file) else {
            return;
        };
        assert_eq!(drawn.matches("<canvas").count(), charts, "{verb}");
    }
}

#[test]
fn no_two_shapers_share_a_colour() {
    let folder = TempDir::new().unwrap();
    let page = page(folder.path(), "compare", "compare.html");
    let table = page.split("<table").nth(1).unwrap();
    let table = table.split("</table").next().unwrap();
    let lines = table.split("border-top:.15rem ").skip(1);
    let colours: Vec<&str> = lines.map(|rest| rest.split(')').next().unwrap()).collect();
    assert_eq!(colours.len(), quell::shapers::SHAPERS.len());
    assert_eq!(
        colours.iter().collect::<BTreeSet<_>>().len(),
        colours.len(),
        "{colours:?}"
    );
}

/// The picture of a train on a telephone: ten taps at 250 Hz, four of which stand within 12 ms.
#[test]
fn no_two_numbers_of_a_train_overlap() {
    let script = include_str!("../crates/page/assets/placed.js");
    let folder = TempDir::new().unwrap();
    let out = folder.path().join("out");
    std::fs::create_dir(&out).unwrap();
    let checks = "const dots = [[0, 96, .18], [74, 64, .231], [79, 93, .185], [148, 149, .0991], [153, 110, .159],
        [158, 171, .0635], [222, 204, .0141], [227, 191, .034], [232, 195, .0272], [237, 208, .00726]]
        .map(([x, y, value]) => ({ x, y, value, words: String(value), half: 4 * String(value).length }));
      const found = placed(dots, 212, { left: -10, right: 280 }, 1);
      const box = (w) => [w.at[0] - w.half, w.at[0] + w.half, w.at[1] - 6, w.at[1] + 6];
      const over = (a, b) => a[0] < b[1] && b[0] < a[1] && a[2] < b[3] && b[2] < a[3];
      const boxes = found.map(box), stems = dots.map((d) => [d.x - 1, d.x + 1, d.y, 212]);
      const clashes = boxes.flatMap((a, i) => [...boxes.slice(i + 1), ...stems].filter((b) => over(a, b)));
      const inside = ([x, y], b) => x > b[0] && x < b[1] && y > b[2] && y < b[3];
      const along = ([[x0, y0], [x1, y1]]) => [...Array(100).keys()].map((k) => [x0 + k / 99 * (x1 - x0), y0 + k / 99 * (y1 - y0)]);
      const passed = found.filter((w) => w.led).flatMap((w) => boxes.filter((b, i) => found[i] !== w && along(w.led).some((p) => inside(p, b))));
      document.body.append(`placed ${found.length}, clashes ${clashes.length + passed.length}`);";
    let page = format!("<body></body><script>{script}</script><script>{checks}</script>");
    std::fs::write(out.join("placed.html"), page).unwrap();
    let Some(drawn) = drawn(folder.path(), "placed.html") else {
        return;
    };
    let told = drawn.split("placed ").last().unwrap_or_default();
    let (count, rest) = told.split_once(", clashes ").expect(&drawn);
    assert!(count == "10" && rest.starts_with('0'), "{told}");
}

/// The page of a telephone: a table that is wider than its place names each value, and nothing is moved sideways.
#[test]
fn a_wide_table_is_listed_where_the_page_is_narrow() {
    let folder = TempDir::new().unwrap();
    let page = page(folder.path(), "compare", "compare.html");
    for width in ["390", "1000"] {
        let style = format!("<style>main{{width:{width}px}}</style></head>");
        let file = folder.path().join(format!("out/{width}.html"));
        std::fs::write(file, page.replace("</head>", &style)).unwrap();
    }
    let (Some(wide), Some(narrow)) = (
        drawn(folder.path(), "1000.html"),
        drawn(folder.path(), "390.html"),
    ) else {
        return;
    };
    let listed = |page: &str| page.matches("class=\"wide listed\"").count();
    assert_eq!(listed(&wide), 0);
    assert_eq!(listed(&narrow), 2);
    assert!(narrow.contains("data-name=\"at -25 %\""));
    assert!(narrow.contains("data-name=\"delay (s)\""));
}

/// What a script's checks say, in a page of its own.
fn checked(script: &str, kind: &str, checks: &str) -> Option<String> {
    let folder = TempDir::new().unwrap();
    let out = folder.path().join("out");
    std::fs::create_dir(&out).unwrap();
    let body = format!(
        "<body></body><script{kind}>{script}\n\
         const answer = (() => {{ {checks} }})(); document.body.append(`told ${{answer}}.`);</script>"
    );
    std::fs::write(out.join("checked.html"), body).unwrap();
    let drawn = drawn(folder.path(), "checked.html")?;
    let told = drawn.rsplit("told ").next().unwrap_or_default();
    Some(told.split(".<").next().unwrap_or_default().to_string())
}

/// Two knocks within a pixel and a change of payload, whose words are as long as the way to the next line: on a chart of
/// 270 px they left it no room.
#[test]
fn words_above_a_chart_leave_it_its_room() {
    let checks = "const lines = [[151.3, 'external disturbance'], [150.9, 'external disturbance'], [97, 'payload change']];
        const items = lines.map(([at, label]) => ({ at, label, line: true }));
        const found = inRows([...items, { at: 26, label: 'held out', line: false }], 260, (text) => 6.2 * text.length);
        const over = (a, b) => a !== b && a.row === b.row && a.left < b.left + b.width && b.left < a.left + a.width;
        return [found.length, found.filter((a) => found.some((b) => over(a, b))).length,
            Math.max(...found.map((one) => one.row)) < 4, found[0].label].join();";
    let script = include_str!("../crates/page/assets/rows.js");
    if let Some(told) = checked(script, "", checks) {
        assert_eq!(told, "3,0,true,external disturbance (2)");
    }
}

#[test]
fn an_axis_has_round_numbers() {
    let ticks = include_str!("../assets/service/ticks.js");
    let checks = "return [angles(-63, 97), angles(-4.2, 4.2), ticks(7.9, 8.3)].join(' ');";
    if let Some(told) = checked(ticks, " type=\"module\"", checks) {
        assert_eq!(told, "-60,-30,0,30,60,90 -4,-2,0,2,4 7.9,8,8.1,8.2,8.3");
    }
    let ruled = include_str!("../crates/page/assets/ruled.js");
    let checks = "const u = (width) => ({ axes: [{ side: 2 }], scales: { x: { min: 0.122, max: 122 } }, bbox: { width } });
        const lines = (width) => ruled({ log: true })(u(width), [0.122, 0.2, 1, 30], 0).map((v) => v ?? '-');
        return [lines(900), lines(90)].join(' ');";
    if let Some(told) = checked(ruled, "", checks) {
        assert_eq!(told, "-,0.2,1,30 -,-,1,-");
    }
}
