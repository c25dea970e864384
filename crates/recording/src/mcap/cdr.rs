//! CDR, the encoding of messages in ROS 2. Numbers have their own alignment, counted from behind four bytes
//! with the byte order.
//!
//! Source: OMG, Common Object Request Broker Architecture 3.3, part 2, 9.3 (CDR); OMG, DDSI-RTPS 2.5, 10.2
//! (the encapsulation header).

/// Bytes before the body: representation (0 is big, 1 is little endian) and options.
const HEADER: usize = 4;

/// Writes one message in little endian.
#[derive(Debug)]
pub struct Encoder {
    bytes: Vec<u8>,
}

impl Default for Encoder {
    fn default() -> Self {
        Self::new()
    }
}

impl Encoder {
    /// An empty message, its header only.
    pub fn new() -> Self {
        Self {
            bytes: vec![0, 1, 0, 0],
        }
    }

    /// Begins the next message in the same buffer.
    pub fn clear(&mut self) {
        self.bytes.truncate(HEADER);
    }

    /// The message so far.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    fn align(&mut self, size: usize) {
        let body = self.bytes.len() - HEADER;
        self.bytes.resize(HEADER + body.next_multiple_of(size), 0);
    }

    /// Adds an integer, aligned.
    pub fn i32(&mut self, value: i32) {
        self.align(4);
        self.bytes.extend(value.to_le_bytes());
    }

    /// Adds an integer, aligned.
    pub fn u32(&mut self, value: u32) {
        self.align(4);
        self.bytes.extend(value.to_le_bytes());
    }

    /// Adds a number, aligned.
    pub fn f64(&mut self, value: f64) {
        self.align(8);
        self.bytes.extend(value.to_le_bytes());
    }

    /// The length with the closing zero, the bytes, the zero.
    pub fn string(&mut self, text: &str) {
        self.u32(text.len() as u32 + 1);
        self.bytes.extend(text.bytes());
        self.bytes.push(0);
    }

    /// `float64[]`.
    pub fn f64s(&mut self, values: &[f64]) {
        self.u32(values.len() as u32);
        values.iter().for_each(|value| self.f64(*value));
    }

    /// `std_msgs/msg/Float64MultiArray`: of each dimension its label and size, the outermost first, and the data, the innermost
    /// dimension side by side. The last stride is the innermost size.
    pub fn float64_multi_array(&mut self, dimensions: &[(&str, usize)], data: &[f64]) {
        self.u32(dimensions.len() as u32);
        for (index, (label, size)) in dimensions.iter().enumerate() {
            let stride: usize = dimensions[index..].iter().map(|(_, size)| size).product();
            self.string(label);
            self.u32(*size as u32);
            self.u32(stride as u32);
        }
        // No values stand before the data.
        self.u32(0);
        self.f64s(data);
    }
}

/// Reads one message of either byte order; every read is checked against the available bytes.
#[derive(Debug)]
pub struct Decoder<'a> {
    body: &'a [u8],
    at: usize,
    is_little: bool,
}

/// Why a body cannot be read: the offset in the message, and what was expected there.
#[derive(Clone, Debug, PartialEq)]
pub struct Damage {
    /// Byte of the message.
    pub offset: usize,
    /// The fault there.
    pub what: String,
}

impl<'a> Decoder<'a> {
    /// Begins to read a message.
    ///
    /// # Errors
    /// [`Damage`] where the header is not that of CDR.
    pub fn new(message: &'a [u8]) -> Result<Self, Damage> {
        let damage = |what: String| Damage { offset: 0, what };
        let (header, body) = message
            .split_at_checked(HEADER)
            .ok_or_else(|| damage("it is shorter than the header of its encoding".into()))?;
        let is_little = match header[..2] {
            [0, 0] => false,
            [0, 1] => true,
            [first, second] => {
                return Err(damage(format!(
                    "its encoding is {first:02x} {second:02x}, not CDR"
                )));
            }
            _ => return Err(damage("it has no encoding".into())),
        };
        Ok(Self {
            body,
            at: 0,
            is_little,
        })
    }

    /// Damage at the present position.
    pub fn damage(&self, what: impl Into<String>) -> Damage {
        Damage {
            offset: HEADER + self.at,
            what: what.into(),
        }
    }

    /// Bytes that are left.
    pub fn left(&self) -> usize {
        self.body.len() - self.at
    }

    /// `count` bytes as they are.
    pub fn bytes(&mut self, count: usize) -> Result<&'a [u8], Damage> {
        let left = self.left();
        if count > left {
            return Err(self.damage(format!("{count} bytes are to follow, {left} are there")));
        }
        let bytes = &self.body[self.at..self.at + count];
        self.at += count;
        Ok(bytes)
    }

    /// The bytes of one number at its alignment, in little endian.
    pub fn number<const N: usize>(&mut self) -> Result<[u8; N], Damage> {
        let padding = self.at.next_multiple_of(N) - self.at;
        self.bytes(padding)?;
        let mut number = [0; N];
        number.copy_from_slice(self.bytes(N)?);
        if !self.is_little {
            number.reverse();
        }
        Ok(number)
    }

    /// The length of a sequence or of a string.
    pub fn length(&mut self) -> Result<usize, Damage> {
        Ok(u32::from_le_bytes(self.number()?) as usize)
    }

    /// A string, without its closing zero.
    pub fn string(&mut self) -> Result<&'a str, Damage> {
        let length = self.length()?;
        let bytes = self.bytes(length)?;
        let text = bytes.strip_suffix(&[0]).unwrap_or(bytes);
        core::str::from_utf8(text).map_err(|_| self.damage("a string is not UTF-8"))
    }
}
