//! The page in a real browser, at the width of a desk and of a phone, light and dark: nothing is cut off, nothing empty.
//! Skipped, with a word, where there is no Chromium.

use std::path::{Path, PathBuf};
use std::process::Command;

/// Names of Chromium; Debian's package is `chromium`.
const NAMES: [&str; 4] = ["chromium", "chromium-browser", "google-chrome", "chrome"];

/// Looks for what is cut off or empty, and tells whoever shows the page.
const CHECK: &str = r#"<script>
addEventListener('load', () => {
  const bad = [], root = document.documentElement, name = e => e.tagName + ' ' + (e.textContent || e.alt || '').slice(0, 50);
  if (root.scrollWidth > root.clientWidth) bad.push('the page is wider than the window: ' + root.scrollWidth);
  for (const e of document.querySelectorAll('h1,h2,h3,h4,p,figcaption,li,nav'))
    if (e.scrollWidth > e.clientWidth + 1 && e.clientWidth > 0) bad.push('cut off: ' + name(e));
  const plots = [...document.querySelectorAll('svg.plot')];
  for (const svg of plots) {
    const outer = svg.getBoundingClientRect();
    if (outer.width < 200 || outer.height < 60) bad.push('a plot is tiny: ' + svg.getAttribute('aria-label'));
    for (const text of svg.querySelectorAll('text')) {
      const r = text.getBoundingClientRect();
      if (r.left < outer.left - 1 || r.right > outer.right + 1 || r.top < outer.top - 1 || r.bottom > outer.bottom + 1)
        bad.push('cut off in ' + svg.getAttribute('aria-label') + ': ' + text.textContent);
    }
    if (svg.querySelectorAll('[fill^="var(--c"],[stroke^="var(--c"]').length < 2)
      bad.push('a plot is empty: ' + svg.getAttribute('aria-label'));
  }
  for (const img of document.querySelectorAll('img')) if (!img.naturalWidth) bad.push('no picture: ' + img.alt);
  for (const t of document.querySelectorAll('tbody')) if (!t.rows.length) bad.push('a table is empty: ' + name(t.parentNode.parentNode));
  parent.postMessage({ bad, seen: plots.length + ' plots, ' + document.images.length + ' pictures', height: root.scrollHeight }, '*');
});
</script>"#;

fn browser() -> Option<PathBuf> {
    let folders = std::env::var_os("PATH")?;
    std::env::split_paths(&folders)
        .flat_map(|folder| NAMES.map(|name| folder.join(name)))
        .find(|path| path.is_file())
}

fn run(browser: &Path, dark: bool, words: &[String]) -> std::process::Output {
    let profile = tempfile::tempdir().unwrap();
    let mut command = Command::new(browser);
    command.args(
        "--headless --no-sandbox --disable-gpu --disable-quic --no-first-run --disable-background-networking \
         --disable-component-update --disable-sync --hide-scrollbars --disable-dev-shm-usage"
            .split_whitespace(),
    );
    command.arg(format!("--user-data-dir={}", profile.path().display()));
    // 0 is dark, 1 is light.
    command.arg(format!("--blink-settings=preferredColorScheme={}", u8::from(!dark)));
    command.args(words).output().unwrap()
}

/// Mean brightness and the number of colours.
fn look(picture: &Path, width: u32) -> (f64, usize) {
    let bytes = std::fs::read(picture).unwrap();
    let ([across, _], pixels) = slimkd_util::png::read(&bytes, |_| Ok(1 << 30)).unwrap();
    let (mut sum, mut count, mut colours) = (0.0, 0.0, std::collections::HashSet::new());
    for pixel in pixels.chunks(across as usize).flat_map(|row| row.iter().take(width as usize)) {
        sum += pixel.iter().map(|&channel| f64::from(channel)).sum::<f64>() / 3.0;
        count += 1.0;
        colours.insert(pixel);
    }
    (sum / count, colours.len())
}

#[test]
fn nothing_is_cut_off_or_empty() {
    let Some(browser) = browser() else {
        slimkd_util::missing("chromium", "Debian: apt-get install chromium");
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    crate::common::report(folder.path(), None).unwrap();
    let page = std::fs::read_to_string(folder.path().join("index.html")).unwrap();
    std::fs::write(folder.path().join("checked.html"), page.replace("</body>", &format!("{CHECK}</body>")))
        .unwrap();
    for width in [1280, 390] {
        // A frame is as narrow as it is told to be, a window is not.
        let frame = format!(
            "<body style='margin:0'><iframe src='checked.html' style='border:0;width:{width}px;height:4000px'></iframe>\
             <script>addEventListener('message', e => document.body.dataset.said = JSON.stringify(e.data))</script></body>"
        );
        let path = folder.path().join("frame.html");
        std::fs::write(&path, frame).unwrap();
        let address = format!("file://{}", path.display());
        let budget = "--virtual-time-budget=4000".to_owned();
        let said = run(&browser, false, &["--dump-dom".to_owned(), budget.clone(), address.clone()]);
        let said = String::from_utf8_lossy(&said.stdout).into_owned();
        assert!(said.contains("&quot;bad&quot;:[],"), "{width}: {said}");
        let mut brightness = Vec::new();
        for dark in [false, true] {
            let picture = folder.path().join("screen.png");
            let words = [
                format!("--screenshot={}", picture.display()),
                "--window-size=1280,4000".to_owned(),
                budget.clone(),
                address.clone(),
            ];
            run(&browser, dark, &words);
            let (bright, colours) = look(&picture, width);
            assert!(colours > 200, "{width}, dark: {dark}: {colours} colours");
            brightness.push(bright);
        }
        assert!(brightness[0] > 150.0 && brightness[1] < 100.0, "{width}: {brightness:?}");
    }
}
