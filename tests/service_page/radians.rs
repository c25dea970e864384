//! A robot of two joints over UDP: one has a sensor in radians, and one is never heard.

use super::browser::Browser;
use super::process::service;
use serde_json::json;
use std::net::UdpSocket;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::thread::JoinHandle;
use std::time::Duration;

const CONFIG: &str = "[service]\nrobot = \"udp\"\n[udp]\naddress = \"ADDRESS\"\n\
    [[joint]]\nname = \"heard\"\n[[joint]]\nname = \"silent\"\n";

/// A joint that stands still and trembles, told a hundred times a second until it is dropped.
struct Robot {
    ending: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Robot {
    fn start(service: std::net::SocketAddr) -> Self {
        let ending = Arc::new(AtomicBool::new(false));
        let end = Arc::clone(&ending);
        let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
        let thread = std::thread::spawn(move || {
            for tick in 0_u32.. {
                if end.load(Relaxed) {
                    break;
                }
                let time = 0.01 * f64::from(tick);
                let deformation = 1e-3 * (40.0 * time).sin();
                let said = json!({"t": time, "joint": "heard", "motor_position": 0.5, "deformation": deformation});
                // The service may have ended.
                let _ = socket.send_to(said.to_string().as_bytes(), service);
                std::thread::sleep(Duration::from_millis(10));
            }
        });
        Self {
            ending,
            thread: Some(thread),
        }
    }
}

impl Drop for Robot {
    fn drop(&mut self) {
        self.ending.store(true, Relaxed);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

/// Points of the curves' colours: axes and grid are grey.
fn coloured(chart: &str) -> String {
    format!(
        "(() => {{ const canvas = document.querySelector('{chart} canvas'); \
         const {{ data }} = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height); \
         let count = 0; \
         for (let i = 0; i < data.length; i += 4) {{ \
           const rgb = data.subarray(i, i + 3); \
           if (data[i + 3] > 100 && Math.max(...rgb) - Math.min(...rgb) > 60) count += 1; }} \
         return count; }})()"
    )
}

#[test]
fn a_sensor_in_radians_is_drawn_in_radians_and_a_silent_joint_has_no_curves() {
    let folder = tempfile::tempdir().unwrap();
    let Some(mut browser) = Browser::start(&folder.path().join("profile")) else {
        return;
    };
    // A free port, as the file of the configuration has to name one.
    let free = UdpSocket::bind("127.0.0.1:0").unwrap();
    let address = free.local_addr().unwrap();
    drop(free);
    let file = folder.path().join("quell.toml");
    std::fs::write(&file, CONFIG.replace("ADDRESS", &address.to_string())).unwrap();
    let (_process, page) = service(folder.path(), &["--config", &file.display().to_string()]);
    let _robot = Robot::start(address);
    browser.open(&page);
    let unit = |text: &str| {
        format!("document.querySelector('#deformation-unit').textContent === '{text}'")
    };
    browser.until(&unit(", mrad"));
    for chart in ["#position", "#deformation"] {
        browser.until(&format!("{} > 0", coloured(chart)));
    }
    let select = |joint: &str| {
        format!(
            "(() => {{ const joint = document.querySelector('#joint'); joint.value = '{joint}'; \
             joint.dispatchEvent(new Event('change')); }})()"
        )
    };
    browser.value(&select("silent"));
    browser.until(&unit(""));
    browser.until("document.querySelector('#about').textContent.includes('silent')");
    for chart in ["#position", "#deformation", "#estimate"] {
        browser.until(&format!("{} === 0", coloured(chart)));
    }
    assert_eq!(browser.text("#figures dd"), "– deg");
    assert_eq!(
        browser.value("document.querySelectorAll('#train circle').length"),
        json!(0)
    );
    assert_eq!(browser.text("#bars-note"), "No move yet.");
    browser.value(&select("heard"));
    browser.until(&unit(", mrad"));
    browser.until(&format!("{} > 0", coloured("#position")));
    browser.assert_sound();
}
