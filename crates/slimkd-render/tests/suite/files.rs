//! Pictures on disk.

use slimkd_render::{BitDepth, Development, Film, FilmError, ToneMap};
use std::path::Path;

fn film() -> Film {
    let mut film = Film::new(13, 7).unwrap();
    for (k, pixel) in film.pixels_mut().iter_mut().enumerate() {
        *pixel = [k as f32 / 90.0, (k % 13) as f32 * 0.3, 4.0 - k as f32 / 30.0];
    }
    film
}

/// A PNG as it is, undecoded by the code that is tested.
fn read(path: &Path) -> (png::ColorType, png::BitDepth, Vec<u8>) {
    let file = std::io::BufReader::new(std::fs::File::open(path).unwrap());
    let mut reader = png::Decoder::new(file).read_info().unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    let frame = reader.next_frame(&mut bytes).unwrap();
    (frame.color_type, frame.bit_depth, bytes)
}

#[test]
fn png_round_trip() {
    let folder = tempfile::tempdir().unwrap();
    let (film, development) = (film(), Development { exposure: -0.5, tone_map: ToneMap::Neutral });
    let eight = folder.path().join("eight.PNG");
    film.save(&eight, &development, BitDepth::Eight).unwrap();
    let (colour, depth, bytes) = read(&eight);
    assert_eq!((colour, depth), (png::ColorType::Rgb, png::BitDepth::Eight));
    assert_eq!(bytes, film.to_srgb8(&development));

    let sixteen = folder.path().join("sixteen.png");
    film.save(&sixteen, &development, BitDepth::Sixteen).unwrap();
    let (colour, depth, bytes) = read(&sixteen);
    assert_eq!((colour, depth), (png::ColorType::Rgb, png::BitDepth::Sixteen));
    for (pixel, linear) in bytes.chunks_exact(6).zip(film.pixels()) {
        let expected = development.develop((*linear).into()) * 65535.0;
        let channel = |k: usize| f32::from(u16::from_be_bytes([pixel[2 * k], pixel[2 * k + 1]]));
        assert!((0..3).all(|k| (channel(k) - expected[k]).abs() <= 0.5 + 1e-2));
    }
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2, "temporary files are left");
}

#[test]
fn exr_round_trip_is_exact() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("linear.exr");
    let film = film();
    std::fs::write(&path, "an older file is replaced").unwrap();
    film.save(&path, &Development { exposure: 3.0, tone_map: ToneMap::Reinhard }, BitDepth::Eight).unwrap();
    let read = exr::prelude::read_first_rgba_layer_from_file(
        &path,
        |size, _| vec![[0.0_f32; 3]; size.width() * size.height()],
        |pixels, at, (r, g, b, _): (f32, f32, f32, f32)| pixels[at.y() * 13 + at.x()] = [r, g, b],
    )
    .unwrap();
    assert_eq!(read.layer_data.channel_data.pixels, film.pixels());
}

/// More lines than are compressed together, some of noise, which cannot be.
#[test]
fn exr_of_several_blocks_is_read_by_others() {
    let mut rng = slimkd_util::Rng::new(7);
    let pixels: Vec<[f32; 3]> = (0..5 * 41)
        .map(|k| if k < 5 * 16 { [(); 3].map(|()| rng.bits() as f32) } else { [k as f32, 0.5, -1.0] })
        .collect();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("noise.exr");
    let mut file = std::fs::File::create(&path).unwrap();
    slimkd_util::exr::write(&mut file, [5, 41], &pixels).unwrap();
    let read = exr::prelude::read_first_rgba_layer_from_file(
        &path,
        |size, _| vec![[0.0_f32; 3]; size.width() * size.height()],
        |pixels, at, (r, g, b, _): (f32, f32, f32, f32)| pixels[at.y() * 5 + at.x()] = [r, g, b],
    );
    assert_eq!(read.unwrap().layer_data.channel_data.pixels, pixels);
}

#[test]
fn refusals_say_what_to_do() {
    let film = film();
    let save = |path: &Path| film.save(path, &Development::default(), BitDepth::Eight).unwrap_err();
    for name in ["picture", "picture.jpg", "", ".png"] {
        let error = save(name.as_ref());
        assert!(matches!(error, FilmError::UnknownFormat(_)), "{name}");
        assert!(error.to_string().contains("end the name in .png or .exr"));
        assert!(Film::check_format(name.as_ref()).is_err());
    }
    let folder = tempfile::tempdir().unwrap();
    let missing = folder.path().join("no/such/folder/picture.png");
    assert!(save(&missing).to_string().contains("choose a folder that exists"));
    let directory = folder.path().join("directory.png");
    std::fs::create_dir(&directory).unwrap();
    assert!(matches!(save(&directory), FilmError::Write { .. }));
    assert!(matches!(Film::new(0, 5), Err(FilmError::Size { .. })));
    assert!(matches!(Film::new(u32::MAX, u32::MAX), Err(FilmError::Size { .. })));
}

#[cfg(unix)]
#[test]
fn a_picture_has_the_rights_of_any_new_file() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().unwrap();
    let (ours, plain) = (folder.path().join("a.png"), folder.path().join("b"));
    film().save(&ours, &Development::default(), BitDepth::Eight).unwrap();
    std::fs::write(&plain, "").unwrap();
    let mode = |path: &Path| std::fs::metadata(path).unwrap().permissions().mode();
    assert_eq!(mode(&ours), mode(&plain));
}
