--  SPDX-License-Identifier: Apache-2.0

with System;

package body RobotTestingFramework.Registry is

   use type System.Address;

   Registered : Maker;

   procedure Exported_Create with Import, Convention => C, External_Name => Test_Create_Symbol;
   pragma Weak_External (Exported_Create);

   function Register (Make : not null Maker) return Boolean is
   begin
      if Registered /= null then
         raise Program_Error with "a plug-in has one test or fixture, this one has several";
      end if;
      Registered := Make;
      return True;
   end Register;

   procedure Make is
   begin
      if Registered /= null then
         Registered.all;
      elsif Exported_Create'Address /= System.Null_Address then
         Exported_Create;
      else
         raise Program_Error
           with "the plug-in has no test: neither is TestCase.Register instantiated nor `"
           & Test_Create_Symbol & "` exported";
      end if;
   end Make;

end RobotTestingFramework.Registry;
