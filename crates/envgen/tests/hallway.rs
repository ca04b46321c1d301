//! Markov hallways against the chain's theory. Seeds are fixed; each tolerance states its
//! false-alarm rate.

use envgen::hallway::{Corners, HallwayChain, HallwaySpec, Start, State};
use envgen::world::Digest;
use envgen::{Blueprint, Seed, Spec};

fn state(number: u8) -> State {
    State::new(number).unwrap()
}

#[test]
fn turns_follow_their_expectation() {
    for (p_st, p_tt, segments, start, expected) in [
        (0.4, 0.0, 50, 3, 14.0816),
        (0.4, 0.0, 50, 5, 14.7959),
        (0.2, 0.3, 80, 3, 17.5309),
        (0.2, 0.3, 80, 5, 18.6420),
    ] {
        let pitch = 3.0;
        let start = Start::State(state(start));
        let spec = HallwaySpec { segments, p_st, p_tt, start, pitch, ..Default::default() };
        let turns: Vec<f64> = (0..10_000)
            .map(|seed| {
                let hallway = spec.generate(Seed(seed)).unwrap();
                hallway.states().iter().filter(|s| s.is_turn()).count() as f64
            })
            .collect();
        let mean = turns.iter().sum::<f64>() / 1e4;
        let variance = turns.iter().map(|t| (t - mean) * (t - mean)).sum::<f64>() / 9999.0;
        // 5 standard errors: false-alarm rate under 1e-6 each.
        let error = 5.0 * (variance / 1e4).sqrt();
        assert!((mean - expected).abs() < error, "{mean} +- {error}, not {expected}");
    }
}

#[test]
fn transitions_follow_the_matrix() {
    // Chi-square a state with one degree of freedom, false-alarm rate 1e-6 each (critical 23.9).
    let (p_st, p_tt) = (0.35, 0.2);
    let chain = HallwayChain::new(p_st, p_tt).unwrap();
    let states = chain.sample(State::UP, 400_000, &mut Seed(2).stream("test", 0));
    let mut counts = [[0.0; 8]; 8];
    for pair in states.windows(2) {
        counts[pair[0].number() as usize - 1][pair[1].number() as usize - 1] += 1.0;
    }
    for (row, law) in counts.iter().zip(chain.matrix()) {
        let n: f64 = row.iter().sum();
        let chi2: f64 = row
            .iter()
            .zip(law)
            .map(|(&seen, p)| {
                if p == 0.0 {
                    assert_eq!(seen, 0.0);
                    0.0
                } else {
                    (seen - n * p) * (seen - n * p) / (n * p)
                }
            })
            .sum();
        assert!(n > 10_000.0 && chi2 < 23.9, "{chi2}");
    }
}

#[test]
fn a_stationary_start_stays_stationary() {
    // Shares of states after 0, 1 and 20 steps: chi-square with 7 degrees of freedom, false-alarm
    // rate 1e-6 each (critical 42.7); up half of the time, left and right a quarter.
    for (p_st, p_tt) in [(0.4, 0.0), (0.2, 0.3), (0.7, 0.9)] {
        let spec = HallwaySpec {
            segments: 21,
            p_st,
            p_tt,
            start: Start::Stationary,
            pitch: 3.0,
            ..Default::default()
        };
        let law = HallwayChain::new(p_st, p_tt).unwrap().stationary().unwrap();
        let hallways: Vec<_> = (0..20_000).map(|seed| spec.generate(Seed(seed)).unwrap()).collect();
        for step in [0, 1, 20] {
            let mut counts = [0.0; 8];
            let mut up = 0.0;
            for hallway in &hallways {
                let state = hallway.states()[step];
                counts[state.number() as usize - 1] += 1.0;
                up += state.exit().y;
            }
            let chi2: f64 = counts
                .iter()
                .zip(law)
                .filter(|(_, p)| *p > 0.0)
                .map(|(c, p)| (c - 2e4 * p) * (c - 2e4 * p) / (2e4 * p))
                .sum();
            assert!(chi2 < 42.7, "{p_st} {p_tt} {step}: {chi2}");
            // 5 sigma of a binomial share.
            assert!((up - 1e4).abs() < 5.0 * (2e4 * 0.25_f64).sqrt(), "{up}");
        }
    }
}

#[test]
fn a_stationary_start_without_a_stationary_law_is_an_error() {
    let spec = HallwaySpec {
        p_st: 0.0,
        p_tt: 1.0,
        start: Start::Stationary,
        pitch: 3.0,
        ..Default::default()
    };
    let error = spec.generate(Seed(0)).unwrap_err().to_string();
    assert!(error.contains("got stationary") && error.contains("not unique"), "{error}");
}

#[test]
fn corridors_that_would_merge_are_refused_with_the_numbers() {
    let spec = HallwaySpec { width: 4.9, ..Default::default() };
    assert_eq!(spec.validate(), Ok(()));
    let wide = HallwaySpec { width: 4.95, ..Default::default() };
    assert_eq!(
        wide.validate().unwrap_err().to_string(),
        "`width` must be at most 4.9 m, got 4.95: with p_tt = 0 parallel arms lie 5 m apart, and \
         the wall between them is 0.1 m thick"
    );
    let u_turns = HallwaySpec { p_tt: 0.1, width: 2.45, ..Default::default() };
    let error = u_turns.validate().unwrap_err();
    assert_eq!((error.field.as_str(), error.value.as_str()), ("width", "2.45"));
}

#[test]
fn bad_numbers_name_field_value_and_limits() {
    type Set = fn(&mut HallwaySpec, f64);
    let fields: [(&str, Set); 6] = [
        ("p_st", |spec, x| spec.p_st = x),
        ("p_tt", |spec, x| spec.p_tt = x),
        ("pitch", |spec, x| spec.pitch = x),
        ("width", |spec, x| spec.width = x),
        ("wall_thickness", |spec, x| spec.wall_thickness = x),
        ("alcove_rate", |spec, x| spec.alcove_rate = x),
    ];
    for (name, set) in fields {
        for value in [f64::NAN, f64::INFINITY, -1.0, 1e300] {
            let mut spec = HallwaySpec::default();
            set(&mut spec, value);
            let error = spec.validate().unwrap_err();
            assert_eq!(error.field, name);
            assert_eq!(error.value.parse::<f64>().unwrap().to_bits(), value.to_bits());
        }
    }
    let spec = HallwaySpec { p_st: 1.000_000_1, ..Default::default() };
    assert_eq!(
        spec.validate().unwrap_err().to_string(),
        "`p_st` must be a number from 0 to 1, got 1.0000001"
    );
    for segments in [0, 1_000_001, u64::MAX] {
        let spec = HallwaySpec { segments, ..Default::default() };
        assert_eq!(spec.validate().unwrap_err().field, "segments");
    }
}

#[test]
fn sums_of_rates_are_compared_and_shown_without_rounding() {
    let spec = |pitch, [alcove_rate, door_frame_rate, narrowing_rate]: [f64; 3]| HallwaySpec {
        pitch,
        width: 0.5,
        alcove_width: 0.5,
        alcove_depth: 0.5,
        door_frame_width: 0.4,
        narrowing_width: 0.4,
        alcove_rate,
        door_frame_rate,
        narrowing_rate,
        ..Default::default()
    };
    // In floating point, these sum to more than 1 and to 0.30000000000000004.
    assert_eq!(spec(1.0, [0.56, 0.33, 0.11]).validate(), Ok(()));
    let error = spec(4.0, [0.1, 0.1, 0.1]).validate().unwrap_err();
    let expected = "`alcove_rate + door_frame_rate + narrowing_rate` must be at most 0.25 1/m, got 0.1 + 0.1 + 0.1: one \
                    per segment of 4 m";
    assert_eq!(error.to_string(), expected);
}

#[test]
fn digests_are_frozen() {
    // A change here is value-breaking: raise the value version and say so in the changelog.
    let figure = HallwaySpec::default();
    let rich = HallwaySpec {
        p_tt: 0.3,
        pitch: 4.0,
        corners: Corners::Rounded,
        start: Start::Stationary,
        alcove_rate: 0.05,
        door_frame_rate: 0.05,
        narrowing_rate: 0.05,
        ..figure.clone()
    };
    let digests = [&figure, &rich].map(|spec| {
        let hallway = spec.generate(Seed(7)).unwrap();
        (Digest::of(&hallway).to_string(), hallway.to_world().digest().to_string())
    });
    assert_eq!(
        digests,
        [
            (
                "f945803e79e1f5993c873f40435c98963732d7f86b96997bbc4c89873a617ceb".to_owned(),
                "aca8db157e1988a9719f698adbc9f72d1cffa74dcd333ce00589fb74f3e5016e".to_owned()
            ),
            (
                "d2672062b4150c229eab6839e1265f1ff1a53f4770d5f943f254cfea0221a3ec".to_owned(),
                "7ae456415d5b46aca0aa3e90e50099ce59f4889f3f52fa1b6fe6b46de0caa4a1".to_owned()
            )
        ]
    );
}

#[test]
fn a_start_is_a_number_or_a_word() {
    let start = |text: &str| {
        let spec = envgen::WorldSpec::from_ron(&format!("Hallway(segments: 5, start: {text})"))?;
        Ok::<_, envgen::SettingsError>(spec.settings_json()["start"].clone())
    };
    for (text, expected) in
        [("stationary", "\"stationary\""), ("\"stationary\"", "\"stationary\""), ("3", "3")]
    {
        assert_eq!(start(text).unwrap().to_string(), expected);
    }
    for text in ["9", "0", "sideways", "\"sideways\"", "1.5", "(1)", "Some(1)"] {
        let error = start(text).unwrap_err().to_string();
        assert!(error.contains("a state from 1 to 8 or stationary"), "{text}: {error}");
    }
}
