// What the bodies do as a file: an animated GIF, or a video in WebM where the browser can record one.
"use strict";

/** Frames per second; of a GIF by hundredths of a second. */
saltus.gifHundredths = 4;
saltus.videoRate = 30;
/** A GIF of more frames has fewer of them per second. */
saltus.mostFrames = 500;
/** The last picture stays so many seconds before it begins again. */
saltus.lastSeconds = 0.6;

/** Times of the frames of a GIF that plays a run with a speed, and the hundredths of a second of each. */
saltus.gifTimes = ([from, to], speed) => {
  const seconds = (to - from) / speed;
  const frames = Math.min(saltus.mostFrames, Math.max(1, Math.round((100 * seconds) / saltus.gifHundredths)));
  const hundredths = Math.max(2, Math.round((100 * seconds) / frames));
  const last = Math.round((100 * saltus.lastSeconds) / hundredths);
  const times = Array.from({length: frames + 1}, (_, k) => from + ((to - from) * k) / frames);
  return {hundredths, times: [...times, ...Array(last).fill(to)]};
};

/** A canvas that shows some pictures below each other, with the time; `paint(time)` draws them as they are now. */
saltus.bodiesCanvas = (pictures) => {
  const sizes = pictures.map((svg) => ["width", "height"].map((name) => Math.ceil(Number(svg.getAttribute(name)))));
  const width = Math.max(...sizes.map(([wide]) => wide));
  const canvas = saltus.element("canvas");
  canvas.width = width;
  canvas.height = sizes.reduce((sum, [, tall]) => sum + tall, 0) + 22;
  const context = canvas.getContext("2d", {willReadFrequently: true});
  const paint = async (time) => {
    const images = await Promise.all(pictures.map((svg) => {
      const image = new Image();
      image.src = `data:image/svg+xml;charset=utf-8,${encodeURIComponent(new XMLSerializer().serializeToString(svg))}`;
      return image.decode().then(() => image);
    }));
    const {panel, text} = saltus.palette();
    context.fillStyle = panel;
    context.fillRect(0, 0, canvas.width, canvas.height);
    let top = 0;
    images.forEach((image, i) => {
      context.drawImage(image, 0, top);
      top += sizes[i][1];
    });
    context.fillStyle = text;
    context.font = "12px ui-monospace, monospace";
    context.fillText(`t = ${saltus.brief(time, 4)}`, saltus.bodiesMargin.l, canvas.height - 7);
  };
  const pixels = () => context.getImageData(0, 0, canvas.width, canvas.height).data;
  return {canvas, paint, pixels};
};

/** An animated GIF. `show(time)` moves the bodies, `report(share)` says how far it is and ends it by false. */
saltus.gifOf = async (pictures, range, speed, show, report) => {
  const {canvas, paint, pixels} = saltus.bodiesCanvas(pictures);
  const {times, hundredths} = saltus.gifTimes(range, speed);
  const picture = async (time) => {
    show(time);
    await paint(time);
    return pixels();
  };
  const samples = [];
  for (const share of [0, 0.25, 0.5, 0.75, 1]) samples.push(await picture(range[0] + share * (range[1] - range[0])));
  const gif = saltus.gifFile(canvas.width, canvas.height, saltus.gifPalette(samples), hundredths);
  for (let k = 0; k < times.length; k += 1) {
    gif.add(await picture(times[k]));
    if (!report((k + 1) / times.length)) return null;
    // The page stays alive.
    if (k % 4 === 0) await new Promise((resume) => setTimeout(resume));
  }
  return gif.file();
};

/** Kind of video that the browser records; null if it records none. */
saltus.videoType = () => {
  if (typeof MediaRecorder === "undefined" || HTMLCanvasElement.prototype.captureStream === undefined) return null;
  return ["video/webm;codecs=vp9", "video/webm;codecs=vp8", "video/webm"].find(MediaRecorder.isTypeSupported) ?? null;
};

/** A video, recorded while it is played; arguments as those of gifOf. */
saltus.videoOf = async (pictures, [from, to], speed, show, report) => {
  const {canvas, paint} = saltus.bodiesCanvas(pictures);
  const stream = canvas.captureStream(0);
  const [track] = stream.getVideoTracks();
  const recorder = new MediaRecorder(stream, {mimeType: saltus.videoType(), videoBitsPerSecond: 6e6});
  const parts = [];
  recorder.ondataavailable = ({data}) => parts.push(data);
  const ended = new Promise((resolve) => (recorder.onstop = resolve));
  const pause = (milliseconds) => new Promise((resume) => setTimeout(resume, milliseconds));
  const frame = async (time) => {
    show(time);
    await paint(time);
    // Older browsers ask the stream.
    (track.requestFrame === undefined ? stream : track).requestFrame();
  };
  await frame(from);
  recorder.start();
  const begin = performance.now();
  let goesOn = true;
  for (let k = 0, time = from; goesOn && time < to; k += 1) {
    time = Math.min(to, from + (speed * (performance.now() - begin)) / 1000);
    await frame(time);
    goesOn = report((time - from) / (to - from || 1));
    await pause(Math.max(0, begin + (1000 * (k + 1)) / saltus.videoRate - performance.now()));
  }
  await frame(to);
  await pause(1000 * saltus.lastSeconds);
  recorder.stop();
  await ended;
  return goesOn ? new Blob(parts, {type: "video/webm"}) : null;
};
