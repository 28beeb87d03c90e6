// Starts the viewer with one layout, layout.json beside this page, and without anything that it would remember.
(async () => {
  const data = await (await fetch("layout.json")).json();
  const layout = {
    id: "log",
    name: "log",
    permission: "CREATOR_WRITE",
    baseline: { data, savedAt: new Date(0).toISOString() },
  };
  const layoutStorage = {
    list: async () => [layout],
    get: async () => layout,
    put: async (_namespace, changed) => changed,
    delete: async () => {},
    importLayouts: async () => {},
  };
  const settings = new Map([
    ["colorScheme", "light"],
    ["launchPreference", "web"],
    ["telemetry.telemetryEnabled", false],
    ["telemetry.crashReportingEnabled", false],
    ["timezone", "UTC"],
    ["time.format", "SEC"],
    ["ui.open-dialog-startup", false],
  ]);
  const appConfiguration = {
    get: (key) => settings.get(key),
    set: async (key, value) => void settings.set(key, value),
    addChangeListener() {},
    removeChangeListener() {},
  };
  await initI18n();
  const dataSources = [new RemoteDataSourceFactory(), new FoxgloveWebSocketDataSourceFactory()];
  const properties = {
    appConfiguration,
    dataSources,
    deepLinks: [location.href],
    enableGlobalCss: true,
    extensionLoaders: [],
    layoutStorage,
  };
  ReactDOM.render(React.createElement(App, properties), document.getElementById("root"));
})();
