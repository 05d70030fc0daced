//! The words of a header, and which of them say plan, measurement, angle, speed, time.

use super::{Quantity, Role};

/// The meaning of one word of a header.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Meaning {
    Role(Role),
    Quantity(Quantity),
    /// A word for a joint; part of its name.
    Joint,
    Time,
    /// A word that no column with joint angles has.
    Foreign,
    /// Anything else: part of a joint's name.
    Name,
}

const PLANNED: &str = "tar sv expected desiderata desiderato desiderate desiderati deseada deseado deseadas deseados théorique theorique ideal leader target targets tgt ziel vorgabe demanded requested planned plan desired des reference references ref rpos setp setpoint setpoints ipo set sp rsol soll sollwert goal nominal nom demand \
    wanted consigne req requests dmd tavoite mål målvärde børverdi trajectory traj fuehrung aspos consigna referencia riferimento alvo ohje ohjearvo börvärde zadana zadane zadany desejado desejada desejados cible hedef gewenst gewenste žádaná požadovaná \
    规划 规划值 计划 期望 期望值 目标 目标值 设定 设定值 给定 给定值 参考 参考值 目標 目標値 設定値 목표 목표값 \
    задание задано заданное заданный уставка план";
const MEASURED: &str = "pfb fdb estimate observed follower actual act rückmeldung rueckmeldung fdbk estimated measured meas feedback fb fbk fpos process present observation ist istwert real sensor encoder enc pv measurement measurements reached rist \
    mess messwert ms aipos mesure mesuré mesurée mesuree réel réelle reel reelle medido medida misurato misurata reale attuale mitattu oloarvo är ärvärde måleverdi \
    zmierzona zmierzone zmierzony rzeczywista rzeczywisty aktualna atual ölçülen gemeten skutečná měřená 实际 实际值 实测 实测值 测量 测量值 反馈 反馈值 当前 当前值 実際 実際値 実測 実測値 現在 現在値 현재 현재값 실제 실제값 측정 측정값 \
    факт фактический фактическое текущее измерено измеренное измеренный";
const COMMAND: &str = "pcmd command commands commanded cmd action actions stell stellwert stellgrösse stellgröße kommando kommandiert befehl gesendet sent commande envoyé envoyée envoye envoyee comando comandado 指令 指令值 指令値 命令 명령";
const POSITION: &str = "q pos position positions posn ang angle angles winkel lage theta phi posición posicion posizione ángulo \
    angulo angolo kulma vinkel ângulo posição posicao kąt pozycja położenie konum açı hoek positie úhel poloha 角度 转角 位置 각도 위치 угол положение";
const VELOCITY: &str = "qd dq vel velocity velocities velo speed omega geschwindigkeit drehzahl qdot dot vitesse velocidad \
    velocità nopeus hastighet 速度 角速度 转速 속도 скорость";
const JOINT: &str = "j joint axis achse gelenk ax axes jnt joints eje asse junta juntas eixo articulação articulacao oś przegub eksen osa axe 关节 関節 軸 轴 관절 ось сустав";
const TIME: &str = "time timestamp timestamps zeit zeitstempel date datum uhrzeit datetime stamp elapsed temps clock ipoc tiempo tempo \
    aika tid czas zaman tijd čas 时间 时刻 時間 時刻 시간 время";
const FOREIGN: &str = "qdd ddq ddot acc accel acceleration beschleunigung torque tau effort moment drehmoment current strom \
    voltage spannung power leistung temperature regelabweichung regeldifferenz temp temperatur pressure druck flow valve ventil spool \
    force kraft mode status error err fehler deviation abweichung lag schleppfehler tcp tool pose cart \
    cartesian euler rpy quat quaternion output input digital analog safety runtime counter seq sequence index scaling fraction robot x y z jerk \
    max min maximum minimum limit limits level gain gains clamp raw temperatures currents torques forces pressures modes voltages quality qualität valid validity statuscode numericid following schleppabstand erreur écart errore \
    pression presión pressione 误差 偏差 压力 电流 电压 温度 力矩 扭矩 流量 加速度 誤差 圧力 電流 電圧 流量 오차 압력 ошибка давление";

fn meaning_of_word(word: &str) -> Meaning {
    let lists = [
        (PLANNED, Meaning::Role(Role::Planned)),
        (MEASURED, Meaning::Role(Role::Measured)),
        (COMMAND, Meaning::Role(Role::Command)),
        (POSITION, Meaning::Quantity(Quantity::Position)),
        (VELOCITY, Meaning::Quantity(Quantity::Velocity)),
        (JOINT, Meaning::Joint),
        (TIME, Meaning::Time),
        (FOREIGN, Meaning::Foreign),
    ];
    let meant = lists.into_iter().find(|(list, _)| list.split_ascii_whitespace().any(|known| known == word));
    meant.map_or(Meaning::Name, |(_, meaning)| meaning)
}

/// One word of a header: its text, whether it stands apart, its meaning.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Word<'a> {
    pub(super) text: &'a str,
    /// Whether anything separates it from the word before.
    pub(super) apart: bool,
    /// Whether a slash alone does.
    pub(super) slashed: bool,
    pub(super) meaning: Meaning,
}

/// How many words of a text that are not in ASCII have a meaning in a header.
#[cfg(feature = "encodings")]
pub(super) fn foreign_words(text: &str) -> usize {
    words(text).iter().filter(|word| !word.text.is_ascii() && word.meaning != Meaning::Name).count()
}

/// Splits at separators, between letters and digits, and where lower case turns into upper case;
/// `istpos` is split too if all of its parts are known.
pub(super) fn words(header: &str) -> Vec<Word<'_>> {
    let mut words = Vec::new();
    let separates = |c: char| !c.is_alphanumeric();
    let mut slashed = false;
    for piece in header.split_inclusive(separates) {
        let (part, first) = (piece.trim_end_matches(separates), words.len());
        if part.is_empty() {
            slashed = false;
            continue;
        }
        let mut start = 0;
        let mut before: Option<char> = None;
        for (at, c) in part.char_indices() {
            let turns = before
                .is_some_and(|b| b.is_numeric() != c.is_numeric() || b.is_lowercase() && c.is_uppercase());
            if turns {
                push(&part[start..at], start == 0, &mut words);
                start = at;
            }
            before = Some(c);
        }
        push(&part[start..], start == 0, &mut words);
        words[first].slashed = slashed;
        // Before a slash it says where a topic is, not what it holds.
        if slashed && first > 0 && words[first - 1].text.eq_ignore_ascii_case("robot") {
            words[first - 1].meaning = Meaning::Name;
        }
        slashed = piece.ends_with('/');
    }
    for at in 1..words.len() {
        let is_position = |word: &Word<'_>| word.meaning == Meaning::Quantity(Quantity::Position);
        let is = |word: &Word<'_>, text: &str| word.text.eq_ignore_ascii_case(text);
        let (before, word) = (&words[at - 1], &words[at]);
        // What a drive makes of its goal, and what it controls to; a `profile_velocity` is a limit.
        if is_position(word) && (is(before, "profile") || is(before, "control")) {
            words[at - 1].meaning = Meaning::Role(Role::Planned);
        } else if is_position(before) && is(word, "diff") {
            words[at].meaning = Meaning::Foreign;
        } else if is(before, "value") && is(word, "y") && !word.apart {
            // What WinCC puts behind a signal.
            let position = Meaning::Quantity(Quantity::Position);
            (words[at - 1].meaning, words[at].meaning) = (position, position);
        } else if (is(word, "ramp") || is(word, "rampe")) && (is(before, "after") || is(before, "nach"))
            || is(before, "ramp") && is(word, "out")
        {
            // The set value on its way to a goal.
            let planned = Meaning::Role(Role::Planned);
            (words[at - 1].meaning, words[at].meaning) = (planned, planned);
        } else if before.text == "q" && !word.apart && (is(word, "in") || is(word, "out")) {
            // What comes in from the encoders, and what goes out to the drives.
            let role = if is(word, "in") { Role::Measured } else { Role::Command };
            words[at].meaning = Meaning::Role(role);
        }
    }
    words
}

fn push<'a>(text: &'a str, apart: bool, words: &mut Vec<Word<'a>>) {
    let lower = text.to_lowercase();
    let meaning = meaning_of_word(&lower);
    // Byte offsets into the lower-case text hold for the text itself where no letter changes its length.
    let cuts = match meaning {
        // Only letters of Europe: no word of others is in two scripts.
        Meaning::Name if lower.len() == text.len() && lower.chars().all(|c| c < '\u{250}') => {
            compound(&lower)
        }
        Meaning::Name if lower == text => unspaced(text),
        _ => None,
    };
    let mut start = 0;
    for end in cuts.unwrap_or_default() {
        let meaning = meaning_of_word(&lower[start..end]);
        words.push(Word { text: &text[start..end], apart: apart && start == 0, slashed: false, meaning });
        start = end;
    }
    if start < text.len() {
        words.push(Word { text: &text[start..], apart: apart && start == 0, slashed: false, meaning });
    }
}

/// Where the parts of a text end that is written without blanks between words, as Chinese and Japanese are: the longest
/// known words, and what lies between them.
fn unspaced(text: &str) -> Option<Vec<usize>> {
    const LONGEST: usize = 3 * 40;
    const FIRST: char = '\u{2e80}';
    if text.len() > LONGEST || !text.starts_with(|c| c >= FIRST) {
        return None;
    }
    let ends = |start: usize| text[start..].char_indices().map(move |(at, c)| start + at + c.len_utf8());
    let mut cuts = Vec::new();
    let mut start = 0;
    while let Some(next) = ends(start).next() {
        match ends(start).rfind(|end| meaning_of_word(&text[start..*end]) != Meaning::Name) {
            Some(end) => {
                cuts.extend([start, end]);
                start = end;
            }
            None => start = next,
        }
    }
    cuts.push(text.len());
    cuts.dedup();
    cuts.retain(|cut| *cut > 0);
    Some(cuts)
}

/// Where the parts of a word of two or three known parts end.
fn compound(word: &str) -> Option<Vec<usize>> {
    const LONGEST: usize = 40;
    if word.len() > LONGEST {
        return None;
    }
    let known = |part: &str| (part.len() > 1 || part == "q") && meaning_of_word(part) != Meaning::Name;
    let cut = |at: &usize| word.is_char_boundary(*at);
    for first in (1..word.len()).filter(cut) {
        if !known(&word[..first]) {
            continue;
        }
        if known(&word[first..]) {
            return Some(vec![first, word.len()]);
        }
        let second =
            (first + 1..word.len()).filter(cut).find(|&at| known(&word[first..at]) && known(&word[at..]));
        if let Some(second) = second {
            return Some(vec![first, second, word.len()]);
        }
    }
    None
}

/// Of a path the last part says most: `fbAxis.SetPos`; what is a command as well was sent: `target_cmd`.
pub(super) fn role(words: &[Word<'_>]) -> Option<Role> {
    let sent = words.iter().any(|word| word.meaning == Meaning::Role(Role::Command));
    words.iter().rev().find_map(|word| match word.meaning {
        Meaning::Role(Role::Planned) if sent => Some(Role::Command),
        Meaning::Role(role) => Some(role),
        _ => None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn split(header: &str) -> Vec<&str> {
        words(header).iter().map(|word| word.text).collect()
    }

    #[test]
    fn headers_split_into_words_however_they_are_written() {
        assert_eq!(split("target_q_0"), ["target", "q", "0"]);
        assert_eq!(split("Achse1Soll"), ["Achse", "1", "Soll"]);
        assert_eq!(split("istpos.J2"), ["ist", "pos", "J", "2"]);
        assert_eq!(split("shoulder_pan_joint"), ["shoulder", "pan", "joint"]);
        assert_eq!(split("qsollwinkel"), ["q", "soll", "winkel"]);
        assert_eq!(split("关节1规划角度"), ["关节", "1", "规划", "角度"]);
        assert_eq!(split("大臂角度设定值"), ["大臂", "角度", "设定值"]);
        assert_eq!(split("目標角度"), ["目標", "角度"]);
        assert_eq!(split("현재각도"), ["현재", "각도"]);
        assert_eq!(split("målvinkel"), ["mål", "vinkel"]);
    }

    #[test]
    fn sides_are_known_in_the_languages_of_those_who_write_them() {
        let pairs = [
            ("Junta 1 posição desejada", "Junta 1 posição atual"),
            ("oś 1 kąt zadany", "oś 1 kąt zmierzony"),
            ("Eksen 1 hedef açı", "Eksen 1 ölçülen açı"),
            ("as 1 gewenste hoek", "as 1 gemeten hoek"),
            ("osa 1 žádaná poloha", "osa 1 skutečná poloha"),
            ("bras consigne", "bras mesuré"),
            ("Axe 1 position théorique", "Axe 1 position réelle"),
            ("Asse 1 posizione desiderata", "Asse 1 posizione reale"),
            ("Eje 1 posición deseada", "Eje 1 posición real"),
        ];
        for (planned, measured) in pairs {
            for (header, role) in [(planned, Role::Planned), (measured, Role::Measured)] {
                let roles =
                    words(header).into_iter().filter(|word| word.meaning == Meaning::Role(role)).count();
                assert_eq!(roles, 1, "{header}");
            }
        }
    }

    #[test]
    fn a_word_that_only_contains_a_known_one_is_a_name() {
        assert_eq!(words("offset")[0].meaning, Meaning::Name);
        assert_eq!(words("Exact")[0].meaning, Meaning::Name);
        assert_eq!(words("profile_velocity")[0].meaning, Meaning::Name);
        for of_plan in ["profile_position_deg", "control_position_deg"] {
            assert_eq!(words(of_plan)[0].meaning, Meaning::Role(Role::Planned));
        }
        assert_eq!(words("Axis1.PosDiff")[3].meaning, Meaning::Foreign);
        for after in ["Boom Sollwert nach Rampe", "setpoint after ramp", "Boom.RampOut"] {
            assert_eq!(words(after).last().unwrap().meaning, Meaning::Role(Role::Planned), "{after}");
        }
        assert_eq!(words("ramp_set")[0].meaning, Meaning::Name);
        assert_eq!(words("diff_left")[0].meaning, Meaning::Name);
    }
}
