--  SPDX-License-Identifier: Apache-2.0
--  The host process, through the binary interface: from Ada's texts to C's.

with RobotTestingFramework.ABI;
with System;

private package RobotTestingFramework.Host is

   --  The table of the host, which create() of the plug-in gets.
   procedure Connect (To : ABI.Host_Access);

   --  Raises Program_Error outside of a plug-in that `rtf run` has started.
   function Table return not null ABI.Host_Access;

   --  Sends a message; an empty file is an unknown place.
   procedure Send
     (Kind       : ABI.Message_Kind;
      Words      : String;
      File       : String;
      Line       : Natural;
      Critical   : Boolean     := False;
      Comparison : ABI.Address := System.Null_Address);

   --  Texts as C sees them. They must outlive what is made of them.
   function To_C (Words : aliased String) return ABI.Text;
   function To_Ada (Words : ABI.Text) return String;

   --  A number as C's %.6g, so that all SDKs print the same.
   function Image (Number : Long_Float) return String;

end RobotTestingFramework.Host;
