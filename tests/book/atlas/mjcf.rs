//! A model of MuJoCo, as far as an effect changes it.

/// What of MuJoCo's model an effect replaces, or adds.
#[derive(Clone, Default)]
pub struct Mjcf {
    pub option: String,
    /// Joints of the motor side, or of the axis.
    pub motor: String,
    /// Joints between motor side and link.
    pub transmission: String,
    pub inertial: String,
    /// Bodies that the link carries.
    pub carried: String,
    pub tendon: String,
    pub actuator: String,
    pub sensor: String,
}

impl Mjcf {
    /// A whole file.
    pub fn whole(&self) -> String {
        let link = match self.transmission.is_empty() {
            true => String::new(),
            false => format!(
                "<inertial pos=\"0 0 0\" mass=\"1\" diaginertia=\"1 1 1\"/>\n<body name=\"link\">\n{}\n",
                self.transmission
            ),
        };
        let carried = match self.carried.is_empty() {
            true => String::new(),
            false => format!("{}\n", self.carried),
        };
        let end = if link.is_empty() { "" } else { "</body>\n" };
        let part = |name: &str, inside: &str| match inside.is_empty() {
            true => String::new(),
            false => format!("<{name}>\n{inside}\n</{name}>\n"),
        };
        let text = format!(
            "<mujoco>\n<compiler angle=\"radian\"/>\n{}\n<worldbody>\n<body name=\"motor\">\n{}\n{link}{}\n{carried}{end}</body>\n\
             </worldbody>\n{}{}{}</mujoco>\n",
            self.option,
            self.motor,
            self.inertial,
            part("tendon", &self.tendon),
            part("actuator", &self.actuator),
            part("sensor", &self.sensor),
        );
        indented(&text)
    }

    /// The elements that another model does not have.
    pub fn beside(&self, base: &Self) -> String {
        let parts = |own: &Self| {
            [
                &own.option,
                &own.motor,
                &own.transmission,
                &own.inertial,
                &own.carried,
                &own.tendon,
                &own.actuator,
                &own.sensor,
            ]
            .map(String::clone)
        };
        let pairs = parts(self).into_iter().zip(parts(base));
        let changed = pairs.filter(|(own, other)| own != other);
        let changed: String = changed.map(|(own, _)| format!("{own}\n")).collect();
        indented(&changed)
    }
}

/// Each line as far in as it is deep.
fn indented(text: &str) -> String {
    let mut depth = 0;
    let line = |line: &str| {
        let ends = line.starts_with("</");
        depth -= usize::from(ends);
        let out = format!("{}{line}\n", "  ".repeat(depth));
        // Attributes may go on in the next line.
        let opens = !ends && line.ends_with('>') && !line.contains("/>") && !line.contains("</");
        depth += usize::from(opens);
        out
    };
    text.lines().map(line).collect()
}
