//! The program `zenoh-bridge-ros2dds` of its published plugin: dds-bridge tcp/HOST:PORT DOMAIN
//!
//! The project's own program is not in the registry of crates; its plugin is.

use zenoh::internal::plugins::PluginsManager;
use zenoh::internal::runtime::RuntimeBuilder;

#[tokio::main]
async fn main() -> Result<(), Box<dyn std::error::Error + Send + Sync>> {
    zenoh::init_log_from_env_or("info");
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [endpoint, domain] = &arguments[..] else {
        return Err("expected tcp/HOST:PORT DOMAIN".into());
    };
    let config = format!(
        "{{ mode: 'router', listen: {{ endpoints: ['{endpoint}'] }}, scouting: {{ multicast: {{ enabled: false }} }},
            timestamping: {{ enabled: true }}, adminspace: {{ enabled: true }}, plugins_loading: {{ enabled: true }},
            plugins: {{ ros2dds: {{ domain: {domain}, ros_localhost_only: true,
                queries_timeout: {{ actions: {{ get_result: ['.*=86400'] }} }} }} }} }}"
    );
    let mut plugins = PluginsManager::static_plugins_only();
    plugins.declare_static_plugin::<zenoh_plugin_ros2dds::ROS2Plugin, &str>("ros2dds", true);
    let mut runtime = RuntimeBuilder::new(zenoh::Config::from_json5(&config)?)
        .plugins_manager(plugins)
        .build()
        .await?;
    runtime.start().await?;
    std::future::pending().await
}
