//! Processes that end with the test.

use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};

/// A process that ends with the test.
pub struct Process(pub Child);

impl Drop for Process {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// The first word of the output that begins so.
pub fn announced(output: impl std::io::Read + Send + 'static, beginning: &str) -> String {
    let mut lines = BufReader::new(output).lines().map_while(Result::ok);
    let word = lines.find_map(|line| {
        let mut words = line.split_whitespace().map(String::from);
        words.find(|word| word.starts_with(beginning))
    });
    // Its output must be taken as long as it lives.
    std::thread::spawn(move || lines.for_each(drop));
    word.unwrap_or_else(|| panic!("no {beginning} was announced"))
}

/// A service with its data in a folder, and the address of its page.
pub fn service(folder: &Path, options: &[&str]) -> (Process, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_quell"));
    command.args(["serve", "--http", "127.0.0.1:0", "--data"]);
    command.arg(folder.join("data")).args(options);
    let mut process = Process(command.stdout(Stdio::piped()).spawn().unwrap());
    let page = announced(process.0.stdout.take().unwrap(), "http://");
    (process, page)
}
