// The modules under test read the page's address only.
Object.assign(globalThis, { document: { baseURI: 'http://service.test/lab/' } });
