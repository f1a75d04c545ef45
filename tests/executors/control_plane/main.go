// The control plane of Kubernetes and `kubectl` as one program, for tests: its name selects the component.
//
// All components are those of Kubernetes. There is no kubelet: node.py runs the pods as processes of this machine.
package main

import (
	"fmt"
	"net/url"
	"os"
	"path/filepath"

	"github.com/spf13/cobra"
	"go.etcd.io/etcd/server/v3/embed"
	"k8s.io/component-base/cli"
	"k8s.io/kubectl/pkg/cmd"
	apiserver "k8s.io/kubernetes/cmd/kube-apiserver/app"
	controllers "k8s.io/kubernetes/cmd/kube-controller-manager/app"
	scheduler "k8s.io/kubernetes/cmd/kube-scheduler/app"
)

func main() {
	components := map[string]func() *cobra.Command{
		"etcd":                    etcd,
		"kube-apiserver":          apiserver.NewAPIServerCommand,
		"kube-controller-manager": controllers.NewControllerManagerCommand,
		"kube-scheduler":          func() *cobra.Command { return scheduler.NewSchedulerCommand() },
		"kubectl":                 cmd.NewDefaultKubectlCommand,
	}
	component := components[filepath.Base(os.Args[0])]
	if component == nil {
		fmt.Fprintln(os.Stderr, "error: the name of the program is not that of a component")
		os.Exit(2)
	}
	os.Exit(cli.Run(component()))
}

// etcd stores the objects in the directory of its first argument, and listens on the URL of its second one.
func etcd() *cobra.Command {
	run := func(_ *cobra.Command, arguments []string) error {
		client, err := url.Parse(arguments[1])
		if err != nil {
			return err
		}
		config := embed.NewConfig()
		config.Dir = arguments[0]
		config.UnsafeNoFsync = true
		config.LogLevel = "warn"
		config.ListenClientUrls = []url.URL{*client}
		config.AdvertiseClientUrls = config.ListenClientUrls
		// No other server joins: any free port.
		config.ListenPeerUrls = []url.URL{{Scheme: "http", Host: "127.0.0.1:0"}}
		config.AdvertisePeerUrls = config.ListenPeerUrls
		config.InitialCluster = config.InitialClusterFromName(config.Name)
		server, err := embed.StartEtcd(config)
		if err != nil {
			return err
		}
		return <-server.Err()
	}
	return &cobra.Command{Use: "etcd DIRECTORY URL", Args: cobra.ExactArgs(2), RunE: run}
}
