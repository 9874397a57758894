// Browsers start no workers for pages that are opened from a disk (file:). The search then runs in a hidden frame instead,
// which is loaded once and spoken to by messages, as a worker is.
if (location.protocol === 'file:') {
  window.Worker = class extends EventTarget {
    constructor(url) {
      super()
      const frame = document.createElement('iframe')
      frame.hidden = true
      const script = new URL(url, location.href).href
      frame.srcdoc =
        '<script>deliver = postMessage.bind(window); postMessage = data => parent.postMessage(data, "*");' +
        'importScripts = (...urls) => Promise.all(urls.map(url => new Promise(resolve => {' +
        'const script = document.createElement("script"); script.src = url; script.onload = resolve;' +
        'document.head.append(script) })))</' + 'script><script src="' + script + '"></' + 'script>'
      this.ready = new Promise(resolve => { frame.onload = resolve })
      window.addEventListener('message', event => {
        if (event.source !== frame.contentWindow) return
        const message = new MessageEvent('message', {data: event.data})
        this.dispatchEvent(message)
        if (this.onmessage) this.onmessage(message)
      })
      document.head.append(frame)
      this.frame = frame
    }

    postMessage(data) {
      this.ready.then(() => this.frame.contentWindow.deliver(data, '*'))
    }

    terminate() {
      this.frame.remove()
    }
  }
}
