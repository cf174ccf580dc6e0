// Headless Chromium through its DevTools protocol on a pipe: no package needed.
import {spawn} from 'node:child_process';
import {mkdtempSync, rmSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {join} from 'node:path';

const kOptions = [
  '--headless=new',
  '--no-sandbox',
  '--disable-dev-shm-usage',
  '--disable-quic',
  '--no-first-run',
  '--disable-background-networking',
  '--disable-component-update',
  '--disable-sync',
  '--hide-scrollbars',
  '--remote-debugging-pipe',
];
const kPatience = 60_000;  // ms for one answer
const kSoftwareWebgl = ['--use-angle=swiftshader', '--enable-unsafe-swiftshader'];

/// The promise, or an error that names what did not come in time.
function inTime(promise, what) {
  let timer;
  const late = new Promise((resolve, reject) => {
    timer = setTimeout(
        () => reject(new Error(`no answer from Chromium in ${kPatience / 1000} s: ${what}`)),
        kPatience);
  });
  return Promise.race([promise, late]).finally(() => clearTimeout(timer));
}

export class Chromium {
  /// @param options.webgl false: a browser without WebGL
  static async start(options = {}) {
    const self = new Chromium();
    self.folder = mkdtempSync(join(tmpdir(), 'stillbase-page-'));
    const webgl = options.webgl === false ? ['--disable-gpu', '--disable-3d-apis'] : kSoftwareWebgl;
    self.process = spawn(
        process.env.CHROMIUM ?? 'chromium',
        [...kOptions, ...webgl, `--user-data-dir=${self.folder}`],
        {stdio: ['ignore', 'ignore', 'ignore', 'pipe', 'pipe']});
    self.pending = new Map();
    self.listeners = [];
    self.count = 0;
    self.process.once('error', error => self.end(error.message));
    self.process.once('exit', (code, signal) => self.end(`Chromium ended (${code ?? signal})`));
    self.process.stdio[3].on('error', error => self.end(error.message));
    let rest = '';
    self.process.stdio[4].setEncoding('utf8').on('data', text => {
      const parts = (rest + text).split('\0');
      rest = parts.pop();
      for (const part of parts) self.receive(JSON.parse(part));
    });
    return self;
  }

  receive(message) {
    if (message.id) {
      const {resolve, reject} = this.pending.get(message.id) ?? {};
      this.pending.delete(message.id);
      message.error ? reject?.(new Error(message.error.message)) : resolve?.(message.result);
    } else {
      for (const listener of this.listeners) listener(message);
    }
  }

  /// Nothing more will be answered.
  end(reason) {
    this.ended = reason;
    for (const {reject} of this.pending.values()) reject(new Error(reason));
    this.pending.clear();
  }

  send(method, params = {}, sessionId = undefined) {
    if (this.ended) return Promise.reject(new Error(this.ended));
    const id = ++this.count;
    const answer = new Promise((resolve, reject) => this.pending.set(id, {resolve, reject}));
    this.process.stdio[3].write(JSON.stringify({id, method, params, sessionId}) + '\0');
    return inTime(answer, method);
  }

  /// Opens a file. The page gathers what the console and the network say.
  /// @param options.width, height, dark, fragment
  async open(file, options = {}) {
    const {targetId} = await this.send('Target.createTarget', {url: 'about:blank'});
    const {sessionId} = await this.send('Target.attachToTarget', {targetId, flatten: true});
    const page = new Page(this, sessionId, targetId);
    await page.prepare(options);
    await page.load(`file://${file}${options.fragment ? `#${options.fragment}` : ''}`);
    return page;
  }

  async close() {
    const exit =
        new Promise(resolve => this.ended ? resolve() : this.process.once('exit', resolve));
    await this.send('Browser.close').catch(() => {});
    const kill = setTimeout(() => this.process.kill('SIGKILL'), 5000);
    await exit;
    clearTimeout(kill);
    rmSync(this.folder, {recursive: true, force: true, maxRetries: 5});
  }
}

class Page {
  constructor(browser, session, target) {
    Object.assign(this, {browser, session, target, messages: [], requests: [], dialogs: 0});
    browser.listeners.push(({method, params, sessionId}) => {
      if (sessionId !== session) return;
      if (method === 'Runtime.exceptionThrown')
        this.messages.push(
            params.exceptionDetails.exception?.description ?? params.exceptionDetails.text);
      if (method === 'Runtime.consoleAPICalled')
        this.messages.push(params.args.map(each => each.value ?? each.description).join(' '));
      if (method === 'Log.entryAdded') this.messages.push(params.entry.text);
      if (method === 'Network.requestWillBeSent' && !/^(file|data|blob):/.test(params.request.url))
        this.requests.push(params.request.url);
      if (method === 'Page.javascriptDialogOpening') {
        ++this.dialogs;
        this.send('Page.handleJavaScriptDialog', {accept: true});
      }
      if (method === 'Page.loadEventFired') this.loaded?.();
    });
  }

  send(method, params) {
    return this.browser.send(method, params, this.session);
  }

  async prepare({width = 1280, height = 800, dark = false}) {
    await Promise.all(
        ['Runtime', 'Log', 'Network', 'Page'].map(domain => this.send(`${domain}.enable`)));
    await this.resize(width, height);
    await this.send(
        'Emulation.setEmulatedMedia',
        {features: [{name: 'prefers-color-scheme', value: dark ? 'dark' : 'light'}]});
  }

  resize(width, height) {
    return this.send(
        'Emulation.setDeviceMetricsOverride', {width, height, deviceScaleFactor: 1, mobile: false});
  }

  async load(url) {
    const loaded = new Promise(resolve => {
      this.loaded = resolve;
    });
    await this.send('Page.navigate', {url});
    await inTime(loaded, url);
  }

  /// The value of an expression in the page; promises are waited for.
  async evaluate(expression) {
    const {result, exceptionDetails} =
        await this.send('Runtime.evaluate', {expression, awaitPromise: true, returnByValue: true});
    if (exceptionDetails)
      throw new Error(exceptionDetails.exception?.description ?? exceptionDetails.text);
    return result.value;
  }

  /// PNG of the window, or of a part of the page {x, y, width, height, scale}.
  async screenshot(clip = undefined) {
    const {data} = await this.send('Page.captureScreenshot', {format: 'png', clip});
    return Buffer.from(data, 'base64');
  }

  async close() {
    await this.browser.send('Target.closeTarget', {targetId: this.target});
  }
}
