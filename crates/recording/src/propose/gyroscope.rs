//! The axes of a gyroscope: that about which it turns most is the joint's.

use super::super::role::Role;
use super::super::unit::Dimension;
use super::content::Content;
use super::inertial;

/// The role of an axis of a gyroscope with several: about one of them its joint turns. It is taken for the one whose rate varies most,
/// and the others have none; `None` for any other column. Where the name tells no unit of a rate, this holds if nothing else in the file has a role.
pub fn role(content: &Content, index: usize) -> Option<Option<(Role, bool)>> {
    let axes = axes(content, index);
    let has_unit = || content.columns[index].name.dimension().is_some();
    let is_meant = axes.len() > 1 && (has_unit() || is_alone(content));
    is_meant
        .then(|| (strongest(content, &axes) == Some(index)).then_some((Role::LinkVelocity, false)))
}

/// Why a column is taken of those that the other axes have.
pub fn why(content: &Content, index: usize) -> Option<String> {
    role(content, index)??;
    let [own, all] = [vec![index], axes(content, index)].map(|some| {
        let titles = some
            .iter()
            .map(|k| format!("{:?}", content.columns[*k].title));
        titles.collect::<Vec<_>>().join(", ")
    });
    Some(format!("{own} varies most of {all}"))
}

/// Whether a column is a rate of turn about an axis.
fn is_rate(content: &Content, index: usize) -> bool {
    let column = &content.columns[index];
    let unit = column.name.dimension();
    let is_unit = unit.is_none_or(|own| own == Dimension::AngularVelocity);
    column.has_numbers() && is_unit && inertial::turns_about(&column.name).is_some()
}

/// The columns of the axes of one gyroscope: their names differ in the axis alone.
fn axes(content: &Content, index: usize) -> Vec<usize> {
    let stem = |k: usize| {
        let name = &content.columns[k].name;
        let words = name.words.split_last().map(|(_, stem)| stem);
        (words, &name.unit)
    };
    let is_like = |k: &usize| is_rate(content, *k) && stem(*k) == stem(index);
    match is_rate(content, index) {
        true => (0..content.columns.len()).filter(is_like).collect(),
        false => Vec::new(),
    }
}

/// Whether nothing in a file but gyroscopes has a role.
fn is_alone(content: &Content) -> bool {
    let mut others = (0..content.columns.len()).filter(|k| !is_rate(content, *k));
    others.all(|k| {
        let name = &content.columns[k].name;
        let is_bare = name.role().is_none() && name.dimension().is_none();
        name.is_time() || is_bare && inertial::axis(name).is_none()
    })
}

/// The column with the most variance: the mean is the offset of a gyroscope. The first of equals.
fn strongest(content: &Content, axes: &[usize]) -> Option<usize> {
    let variance = |index: &usize| content.columns[*index].variance();
    let all = axes.iter().copied().rev();
    all.max_by(|a, b| variance(a).total_cmp(&variance(b)))
}

#[cfg(test)]
mod tests {
    use super::super::propose;

    /// The proposal for three axes with these names, of which the second turns, beside another column.
    fn proposed(names: &str) -> super::super::Proposal {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("imu.csv");
        let row = |k: u32| {
            let t = 1e-3 * f64::from(k);
            let own = (50.0 * t).sin();
            format!(
                "{t:.3},{:.4},{:.4},{:.4},{}\n",
                3.0 + 0.1 * own,
                2.0 * own,
                -9.0,
                k % 7
            )
        };
        let rows: String = (0..400).map(row).collect();
        std::fs::write(&file, format!("{names}\n{rows}")).unwrap();
        propose(&file).unwrap()
    }

    #[test]
    fn of_a_gyroscope_the_axis_that_varies_most_is_taken() {
        for names in [
            "time_s,gyro_x,gyro_y,gyro_z,temperature",
            "time_s,gyro_x [rad/s],gyro_y [rad/s],gyro_z [rad/s],temperature",
            "time_s,wx,wy,wz,temperature",
            "time_s,angular_velocity.x,angular_velocity.y,angular_velocity.z,temperature",
        ] {
            let told = proposed(names);
            let text = &told.manifests[0].text;
            let second = names.split(',').nth(2).unwrap();
            let words = [
                "link_velocity\"  # guessed: ",
                &format!("{second:?} varies most of"),
                &format!("column = {second:?}"),
            ];
            assert!(words.iter().all(|own| text.contains(own)), "{text}");
            assert!(
                text.matches("\n[[channel]]").count() == 1
                    && told.open.is_empty()
                    && told.joints.is_empty(),
                "{told:?}"
            );
        }
        // Beside an accelerometer they are of its body.
        let told = proposed("time_s,wx,wy,wz,gFx");
        assert!(
            !told.manifests[0].text.contains("link_velocity"),
            "{told:?}"
        );
        // Joints of a robot that are called by their axes are joints.
        let told =
            proposed("time_s,wrist_roll [rad/s],wrist_pitch [rad/s],wrist_yaw [rad/s],temperature");
        assert_eq!(told.joints.len(), 3);
    }
}
